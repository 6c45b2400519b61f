"""Tests of the options of `raya study`."""
import pytest
from raya.lab.options import settings_of


def test_options_are_read_in_any_order():
    options = settings_of(["fig8", "--size", "64", "a.nff", "-o", "out", "b.nff"])
    assert (options.study, options.scenes, options.output, options.size, options.seed, options.verbosity) == ("fig8", ["a.nff", "b.nff"], "out", 64, 1, 0)
    assert settings_of(["fig8", "-o", "out", "--shard", "2/3"]).shard == (2, 3)
    assert settings_of(["--missing", "s1", "s2"]).missing == ["s1", "s2"]


@pytest.mark.parametrize("arguments, reason", [
    (["fig8", "-o", "out", "--size", "16"], "--size 16: must be 17..4096 pixels a side"),
    (["fig8", "-o", "out", "--views", "5001"], "--views 5001: must be 20..5000"),
    (["fig8", "-o", "out", "--siz", "64"], "unrecognized arguments: --siz 64"),
    (["fig8", "-o"], "--output expected one argument"),
    (["--check", "m.json", "--strict"], "--check excludes --strict"),
    (["fig8", "--merge", "s1", "--shard", "1/2", "-o", "out"], "--merge excludes --shard"),
    (["fig77", "-o", "out"], r"no study fig77 \(did you mean fig7\?\)"),
])
def test_wrong_options_are_refused(arguments, reason):
    with pytest.raises(ValueError, match=f"study: {reason}.*; see raya study --help"):
        settings_of(arguments)


def test_no_output_folder_contains_an_input(tmp_path):
    (tmp_path / "mine.py").write_text("")
    (tmp_path / "manifest.json").write_text("{}")
    for arguments in ([str(tmp_path / "mine.py")], ["fig8", "--check", str(tmp_path / "manifest.json")], ["fig8", "--merge", str(tmp_path)]):
        with pytest.raises(ValueError, match="would overwrite the input"):
            settings_of([*arguments, "-o", str(tmp_path)])
