"""Records and signatures say what compiled code writes."""

from selforg.compiler.records import Recording
from selforg.declared import fields_of
from selforg.plugins import is_own
from tests import kernels


def test_fields_that_compiled_code_writes_are_kept_or_scratch_and_others_are_read():
    written = kernels.fields_written()
    wrong = {
        f"{kind.__name__}.{name}": field.mark.name
        for kind in Recording.of
        for name, field in fields_of(kind).items()
        if not is_own(kind) and (field.mark.name == "read") == (f"{kind.__name__}.{name}" in written)
    }
    assert wrong == {}


def test_a_reader_of_a_kernel_sees_which_records_it_changes_itself_or_through_others():
    found = kernels.signatures()
    assert {place: right for place, (word, right) in found.items() if word != right} == {}
    assert found["selforg.mechanisms.movement.move_rows(store)"] == ("Written", "Written")
    assert found["selforg.mechanisms.movement.move_rows(poses)"] == ("Handle", "Handle")
