"""Cells of a page's tables, and the command line of a document."""
import pytest

pytest.importorskip("raya", reason="the module is not built; configure with -DRAYA_PYTHON=ON")
from raya.lab import Comparison, Page, Table  # noqa: E402
from raya.lab.document import cells_of_comparisons, cells_of_table, classes_of, command_of  # noqa: E402


@pytest.mark.parametrize("cell, css_class", [  # classes: n, numbers; t, more than 15 characters; w, more than 60
    ("1.5", "n"), ("-", "n"), ("", "n"), ("inf", "n"), ("-1.1102e-14", "n"), ("1.41 +- 0.053", "n"), ("283 ms", "n"),
    ("1.58 (derived)", "n"), ("653 ms (derived)", "n"), ("8 x 8", ""), ("46x46x3", ""), ("64 PEs: objects", ""),
    ("4.80 without the first", "t"), ("fp32", ""), ("a" * 61, "w")])
def test_class_of_a_column_follows_from_its_cells(cell, css_class):
    assert classes_of([["column"], [cell], ["-"]]) == [css_class]


@pytest.mark.parametrize("paper, remark, columns", [
    (None, "", ["", "ours"]), (None, "a draw", ["", "ours", "remark"]),
    (2, "", ["", "A 1999", "ours", "ours / theirs"]), (2, "a draw", ["", "A 1999", "ours", "ours / theirs", "remark"])])
def test_comparisons_have_no_empty_columns(paper, remark, columns):
    page = Page({}, comparisons=[Comparison("u", "ms", paper, 3, remark, True, 0.5)], compared_with="A 1999")
    row = {"": "u", "A 1999": "2 ms (derived)", "ours": "3 +- 0.5 ms", "ours / theirs": "1.5", "remark": remark}
    assert cells_of_comparisons(page) == [columns, [row[name] for name in columns]]


def test_integers_are_printed_without_rounding():
    table = Table("loads", "Loads", [{"p": 100000, "u": 0.5}, {"p": 3, "u": 100000.4}])
    assert cells_of_table(table) == [["p", "u"], ["100000", "0.5"], ["3", "100000"]]


def test_command_of_a_document_names_all_scenes():
    pages = [Page({}, run={"command": f"raya study {arguments} -o DIR"}) for arguments in ("fig7 a.nff", "images a.nff b.nff")]
    assert command_of(pages[:1]) == "raya study fig7 a.nff -o DIR"
    assert command_of(pages) == "raya study all a.nff b.nff -o DIR"
