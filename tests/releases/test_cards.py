"""Every policy that ships has a model card, which is about the weights beside it."""

import hashlib

import pytest

from selector.documents.find import files_of

HEADINGS = (
    "# Model card: ",
    "- **Inputs**: ",
    "- **Training**: ",
    "- **Licence**: ",
    "## Results",
    "## Limits",
    "## Use",
)
POLICIES = {name: path.parent for name, path in files_of("policies").items()}


@pytest.mark.parametrize("name", POLICIES)
def test_a_policy_has_a_card_about_its_weights(name):
    card = (POLICIES[name] / "README.md").read_text(encoding="utf-8")
    places = [card.find(f"{chr(10)}{heading}") for heading in HEADINGS[1:]]
    assert card.startswith(f"{HEADINGS[0]}`{name}`")
    assert -1 not in places
    assert places == sorted(places)
    digest = hashlib.sha256((POLICIES[name] / "policy.safetensors").read_bytes()).hexdigest()
    assert f"sha256 `{digest}`" in card
    assert f"--strategy policy:{name}" in card
