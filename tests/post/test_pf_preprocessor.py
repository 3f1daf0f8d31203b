"""The in-tree test runner: what its preprocessor accepts, refuses and writes, and its checker."""

import subprocess
import sys
from pathlib import Path

import check_failures
import make_funit
import pf_to_fortran
import pytest

FRAMEWORK = Path(__file__).resolve().parents[1] / "framework"

PATH = Path("tests/unit/test_arch.pf")
PASSING = """module test_arch
   use funit
   implicit none
contains
   @test
   subroutine test_one_is_one()
      @assertEqual(1, 1)
   end subroutine test_one_is_one
end module test_arch
"""


def with_statement(statement: str) -> str:
    """Put a statement in the place of the assertion of PASSING, which is on line 7."""
    return PASSING.replace("@assertEqual(1, 1)", statement)


def refusal(source: str) -> tuple[int, str]:
    """Return line and message of the error that a source must give."""
    with pytest.raises(pf_to_fortran.PfError) as caught:
        pf_to_fortran.translate(source, PATH)
    return caught.value.line, str(caught.value)


def run(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run the preprocessor as CMake does."""
    script = FRAMEWORK / "pf_to_fortran.py"
    return subprocess.run([sys.executable, script, *map(str, arguments)], capture_output=True, text=True, check=False)


def test_assertion_becomes_a_call_a_return_and_line_marks() -> None:
    lines = pf_to_fortran.translate(PASSING, PATH).split("\n")
    start = lines.index("  call assertEqual(1, 1, &")
    assert lines[start - 1:start + 4] == [
        '#line 7 "tests/unit/test_arch.pf"',
        "  call assertEqual(1, 1, &",
        " & location=SourceLocation('test_arch.pf', 7))",
        "  if (anyExceptions()) return",
        '#line 8 "tests/unit/test_arch.pf"',
    ]


def test_all_other_lines_are_kept_as_they_are() -> None:
    lines = pf_to_fortran.translate(PASSING, PATH).split("\n")
    assert lines[0] == '#line 1 "tests/unit/test_arch.pf"'
    kept = [line for line in PASSING.split("\n") if "@" not in line]
    assert [line for line in lines if line in kept][:len(kept) - 1] == kept[:-1]
    assert "   !@test" in lines


def test_suite_lists_the_tests_with_what_surrounds_them() -> None:
    source = PASSING.replace("contains\n", """contains
   @before
   subroutine set_up()
   end subroutine set_up
   @AFTER
   ! a remark

   Subroutine tear_down ! another
   end subroutine tear_down
   @Test
   subroutine Test_two()
   end subroutine
""")
    suite = pf_to_fortran.translate(source, PATH).split("end module test_arch\n")[1]
    assert suite == """
function test_arch_suite() result(suite)
   use funit
   use test_arch
   implicit none
   type(TestSuite) :: suite
   type(TestMethod) :: t

   suite = TestSuite('test_arch_suite')
   t = TestMethod('Test_two', &
      Test_two, setUp=set_up, tearDown=tear_down)
   call suite%addTest(t)
   t = TestMethod('test_one_is_one', &
      test_one_is_one, setUp=set_up, tearDown=tear_down)
   call suite%addTest(t)
end function test_arch_suite
"""


@pytest.mark.parametrize("statement", [
    "@assertEqual(1.0_wp, f(x, [1, 2]), tolerance=1.0e-12_wp, message='a, b')",
    "@assertRelativelyEqual(a(1, :), b, message=text, tolerance=eps)",
    "@ASSERTTRUE (x == 1 .and. y <= 2)",
    "@assertFalse(any([(x(i) /= 0, i=1, n)]), message=\"it's (not) ! so; &\")",
    "@assertLessThan(1, 2)",
    "@assertLessThanOrEqual((/ 1, 2 /), x%y(:))",
    "@assertGreaterThan(a, b, tolerance=0.5_wp)",
    "@assertGreaterThanOrEqual('a' // '''', \"b\")",
    "@assertFail('never')",
])
def test_assertions_of_the_subset_keep_their_text(statement: str) -> None:
    text = pf_to_fortran.translate(with_statement(statement), PATH)
    arguments = statement[statement.index("("):-1]
    assert f"{arguments}, &\n & location=" in text


@pytest.mark.parametrize(("statement", "message"), [
    ("@assertEqual(1, &", "one whole line, this one is not closed"),
    ("@assertEqual(1, 1) ! remark", "one whole line, found '! remark' after it"),
    ("@assertEqual(1, 1) ! (remark)", "one whole line, found '! (remark)' after it"),
    ("@assertEqual(1, 1 ! remark)", "one whole line, found '!' in it"),
    ("@assertEqual(1, 1); call f(x)", "one whole line, found '; call f(x)' after it"),
    ("@assertEqual(1, 'a)", "one whole line, this one is not closed"),
    ("@assertEqual(1, [1)]", "brackets do not match at ')'"),
    ("@assertEqual(1)", "@assertEqual wants 2 arguments, found 1"),
    ("@assertTrue()", "@assertTrue wants 1 arguments, found 0"),
    ("@assertFail()", "@assertFail wants 1 arguments, found 0"),
    ("@assertEqual(1,,1)", "@assertEqual has an empty argument"),
    ("@assertEqual(1, 1, )", "@assertEqual has an empty argument"),
    ("@assertEqual(expected=1, actual=1)", "take no keyword, found 'expected='"),
    ("@assertEqual(1, 1, 'a message')", "takes message= and tolerance=, found ''a message''"),
    ("@assertTrue(x, tolerance=1)", "takes message=, found 'tolerance=1'"),
    ("@assertTrue(x, location=here)", "takes message=, found 'location=here'"),
    ("@assertFail('a', message='b')", "takes nothing, found 'message='b''"),
    ("@assertNotEqual(1, 2)", "outside the subset of pFUnit's language: '@assertNotEqual(1, 2)'"),
    ("@assertIsNaN(x)", "outside the subset"),
    ("@assertEqual", "outside the subset"),
    ("@mpitest", "outside the subset"),
    ("@test(ifdef=X)", "outside the subset"),
    ("@disable", "outside the subset"),
    ("#ifdef X", "lines for the C preprocessor are outside the subset"),
])
def test_statement_outside_the_subset_is_refused_with_its_line(statement: str, message: str) -> None:
    line, text = refusal(with_statement(statement))
    assert line == 7
    assert message in text


def test_assertion_may_fill_the_line_but_not_more() -> None:
    blank = "@assertEqual(1, 1, message='')"
    for length, fits in ((124, True), (125, False)):
        statement = blank.replace("''", f"'{'m' * (length - len(blank))}'")
        if fits:
            text = pf_to_fortran.translate(with_statement(statement), PATH)
            assert max(map(len, text.split("\n"))) == 132
        else:
            assert refusal(with_statement(statement)) == (7, "the assertion is 1 characters too long")


@pytest.mark.parametrize(("old", "new", "line", "message"), [
    ("test_one_is_one()", "second()", 6, "begins with test_, found 'second'"),
    ("test_one_is_one()", "test_one_is_one(x)", 6, "a subroutine without arguments"),
    ("   subroutine test_one", "   recursive subroutine test_one", 6, "without arguments"),
    ("   subroutine test_one", "   function test_one", 6, "a subroutine without arguments"),
    ("@test", "@test\n   @test", 6, "a subroutine without arguments, found '@test'"),
    ("module test_arch\n   use", "module test_vault\n   use", 1, "'module test_arch'"),
    ("module test_arch\n   use", "module test_arch ! remark\n   use", 1, "alone on its line"),
    ("module test_arch\n   use", "module a\nend module a\nmodule test_arch\n   use", 1,
     "the one module"),
    ("end module test_arch\n", "end module test_arch\nmodule test_arch\nend module\n", 10,
     "the one module"),
    ("end module test_arch\n", "end module test_arch\n@test\n", 10, "a subroutine after @test"),
    ("   @test\n", "", 5, "@test is missing above it"),
    ("   @test\n", "   @before\n", 9, "ends without a module and a @test"),
    ("   @test\n", "   @after\n   subroutine a\n   end subroutine\n   @after\n   subroutine b\n", 9,
     "there is one @after"),
])
def test_file_of_another_form_is_refused_with_its_line(old: str, new: str, line: int, message: str) -> None:
    assert old in PASSING
    found_line, text = refusal(PASSING.replace(old, new, 1))
    assert (found_line, message in text) == (line, True), text


@pytest.mark.parametrize("path", sorted(FRAMEWORK.parent.rglob("*.pf")), ids=lambda path: path.stem)
def test_every_test_of_the_project_is_in_the_subset(path: Path) -> None:
    pf_to_fortran.translate(path.read_text("utf-8"), path)


def test_case_of_names_does_not_matter() -> None:
    pf_to_fortran.translate(PASSING.replace("module test_arch", "MODULE Test_Arch"), PATH)


def test_commands_write_module_and_driver(tmp_path: Path) -> None:
    source = tmp_path / "test_arch.pf"
    source.write_text(PASSING)
    assert run(source, tmp_path / "test_arch.F90").returncode == 0
    assert (tmp_path / "test_arch.F90").read_text() == pf_to_fortran.translate(PASSING, source)
    assert run("--driver", source, "test_vault.pf", tmp_path / "driver.f90").returncode == 0
    driver = (tmp_path / "driver.f90").read_text()
    assert driver.index("call run_suite(test_arch_suite(), tally)") \
        < driver.index("call run_suite(test_vault_suite(), tally)") \
        < driver.index("call close_report(tally)")


def test_command_says_file_and_line_and_writes_nothing(tmp_path: Path) -> None:
    source = tmp_path / "test_arch.pf"
    source.write_text(with_statement("@assertNear(1, 2)"))
    result = run(source, tmp_path / "test_arch.F90")
    assert result.returncode == 1
    assert result.stderr.startswith(f"{source}:7: error: outside the subset")
    assert not (tmp_path / "test_arch.F90").exists()


@pytest.mark.parametrize("head", ["subroutine test_two()", "  Pure Subroutine TEST_two(x)", "subroutine test_two ! y"])
def test_a_test_without_its_mark_is_refused(head: str) -> None:
    line, text = refusal(PASSING.replace("end module", f"{head}\nend subroutine test_two\nend module"))
    assert line == 9 and "@test is missing" in text


def test_bytes_that_are_not_utf_8_are_refused_with_their_line(tmp_path: Path) -> None:
    path = tmp_path / "test_arch.pf"
    path.write_bytes(PASSING.encode().replace(b"one_is_one()", b"one_is_one() ! \xe9", 1))
    done = run(path, tmp_path / "out.F90")
    assert done.returncode == 1 and not (tmp_path / "out.F90").exists()
    assert done.stderr == f"{path}:6: error: expected UTF-8, got the byte 0xe9\n"


def test_unchanged_source_is_not_written_again(tmp_path: Path) -> None:
    path, out = tmp_path / "test_arch.pf", tmp_path / "out.F90"
    path.write_text(PASSING)
    assert run(path, out).returncode == 0
    before = out.stat().st_mtime_ns
    assert run(path, out).returncode == 0 and out.stat().st_mtime_ns == before


def test_unchanged_driver_is_not_written_again(tmp_path: Path) -> None:
    output = tmp_path / "driver.f90"
    run("--driver", "test_arch.pf", output)
    before = output.stat().st_mtime_ns
    run("--driver", "test_arch.pf", output)
    assert output.stat().st_mtime_ns == before


def test_every_assertion_of_the_subset_has_its_procedures() -> None:
    assert set(make_funit.assertions()) == set(pf_to_fortran.ASSERTIONS)
    names = [name for overloads in make_funit.assertions().values() for name, _ in overloads]
    assert len(names) == len(set(names))
    assert max(map(len, names)) <= 63


REPORT = """ test_arch_suite.test_one_is_one FAILED
    [test_arch.pf:8] AssertEqual
        expected: 3
        found:    4
 FAILED  (1 of 1 tests)
"""


@pytest.fixture
def announcing(tmp_path: Path) -> Path:
    """Return a .pf file that announces the failure of REPORT."""
    path = tmp_path / "test_arch.pf"
    path.write_text(with_statement("! fails: 3 | 4\n      @assertEqual(3, 4)"))
    return path


def test_checker_is_content_with_what_was_announced(announcing: Path) -> None:
    assert check_failures.disagreements(REPORT, 2, [announcing]) == []


@pytest.mark.parametrize(("old", "new", "message"), [
    (":8]", ":9]", "test_arch.pf:8 was announced 1 times and reported 0 times"),
    (":8]", ":9]", "test_arch.pf:9 was announced 0 times and reported 1 times"),
    ("    [", "    [test_arch.pf:8]\n    [", "announced 1 times and reported 2 times"),
    ("found:    4", "found:    5", "test_arch.pf:8: no '4' in its report"),
    ("1 of 1", "1 of 2", "the closing line should count"),
    (" FAILED  (1 of 1 tests)", "", "found none"),
])
def test_checker_finds_what_is_wrong_in_a_report(announcing: Path, old: str, new: str, message: str) -> None:
    problems = check_failures.disagreements(REPORT.replace(old, new, 1), 2, [announcing])
    assert message in "\n".join(problems)


def test_checker_wants_exit_status_two(announcing: Path) -> None:
    assert check_failures.disagreements(REPORT, 0, [announcing]) == ["exit status 2 was wanted, found 0"]
