"""A password is shown nowhere, others cannot read the file of a store, and no URL ends in a traceback."""

import stat

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clean_swarm_env.config.mission import MissionConfig
from selector.store import KnowledgeStore, StoreError
from selector.store.connection import public_url
from train.request import without_secrets

SECRET = "hunter2"
WITH_SECRET = (
    f"postgresql://me:{SECRET}@127.0.0.1:1/db",
    f"postgresql://me@127.0.0.1:1/db?password={SECRET}",
    f"postgresql+pg8000://me:{SECRET}@127.0.0.1:1/db?timeout=x",
)


@pytest.mark.parametrize(
    "url",
    [
        *WITH_SECRET,
        f"postgresql:me:{SECRET}@host/db",
        f"postgresql://me:a@b:{SECRET}@host:1x/db",
        f"mysql://me:{SECRET}@host/db",
        f"sqlite://user:{SECRET}@",
        f"sqlite://user:{SECRET}@//tmp/x",
        f"sqlite:///x?key={SECRET}",
        f"sqlite+duck://:{SECRET}@/x",
    ],
)
def test_no_error_shows_a_password(url):
    with pytest.raises(StoreError) as error:
        KnowledgeStore(url)
    assert SECRET not in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("url", WITH_SECRET)
def test_no_command_manifest_or_recording_shows_a_password(url):
    told = [
        without_secrets(url),
        without_secrets(f"--store={url}"),
        str(MissionConfig(name="m", store=url).model_dump(mode="json")),
    ]
    for text in told:
        assert "postgresql" in text
        assert SECRET not in text


@pytest.mark.parametrize("url", ["k.sqlite", "~/k.sqlite", "sqlite:///k.sqlite", "postgresql://me@host:1/db"])
def test_a_url_without_a_password_is_shown_as_it_is_given(url):
    assert public_url(url) == without_secrets(url) == url
    assert MissionConfig(name="m", store=url).model_dump(mode="json")["store"] == url


def test_only_its_owner_reads_and_writes_a_new_store(tmp_path):
    store = KnowledgeStore(str(tmp_path / "k.sqlite"))
    files = list(tmp_path.iterdir())
    assert {path.name for path in files} >= {"k.sqlite"}
    assert [stat.S_IMODE(path.stat().st_mode) for path in files] == [0o600] * len(files)
    store.close()


ODD = st.text(max_size=12) | st.sampled_from(["~", "~nobody", "..", "?a=b", "%00", "[::", ":", "@", "x" * 5000])


@settings(max_examples=200)
@given(st.sampled_from(["", "sqlite:///", "sqlite://", "postgresql://127.0.0.1:1/"]), st.lists(ODD, max_size=3))
def test_an_odd_url_is_one_line(start, rest):
    with pytest.raises(StoreError) as error:
        KnowledgeStore(start + "/none/".join(["", *rest]), create=False)
    assert "\n" not in str(error.value)
