"""What is wrong with a document, in one line."""

from collections.abc import Callable

import pytest

from selector.documents.errors import DocumentError


def refusal(read: Callable[..., object], *given: object) -> str:
    """Return with what words a document is refused; AssertionError if it is read, or if they are not one line."""
    with pytest.raises(DocumentError) as caught:
        read(*given)
    assert "\n" not in str(caught.value)
    return str(caught.value)
