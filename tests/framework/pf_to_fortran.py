"""Turn a pFUnit test file (.pf) into Fortran, or write the driver that runs such files.

The language is a strict subset of pFUnit's. Whatever lies outside is an error FILE:LINE, so that
a file accepted here compiles under pFUnit too. Its rules:

* one module a file, of the file's name, alone on its line; no lines for the C preprocessor;
* @test, @before and @after stand alone on a line, and the next line that is not a comment is a
  subroutine without arguments; a test is named test_*, and what is named so is a test; one @before
  and one @after a file;
* an assertion is one whole line: no continuation, no comment, no second statement;
* the assertions are those of ASSERTIONS below, with tolerance= and message= as keywords.
"""

import argparse
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

#: Arguments without a keyword, and keywords, of each assertion.
ASSERTIONS = {
    "Equal": (2, {"tolerance", "message"}),
    "RelativelyEqual": (2, {"tolerance", "message"}),
    "LessThan": (2, {"tolerance", "message"}),
    "LessThanOrEqual": (2, {"tolerance", "message"}),
    "GreaterThan": (2, {"tolerance", "message"}),
    "GreaterThanOrEqual": (2, {"tolerance", "message"}),
    "True": (1, {"message"}),
    "False": (1, {"message"}),
    "Fail": (1, set()),
}
LINE_LENGTH = 132  #: Longest line of Fortran; an assertion grows by a few characters when it is translated.
MODULE = re.compile(r"\s*module\s+(?!procedure\b|subroutine\b|function\b)(\w+)(.*)", re.I)
SUBROUTINE = re.compile(r"\s*subroutine\s+(\w+)\s*(\(\s*\))?\s*(!.*)?", re.I)
UNMARKED = re.compile(r"\s*((pure|impure|recursive)\s+)*subroutine\s+(test_\w+).*", re.I)
CLOSES = {"(": ")", "[": "]"}


class PfError(Exception):
    """A line outside the subset."""

    def __init__(self, line: int, text: str) -> None:
        super().__init__(text)
        self.line = line


@dataclass
class Suite:
    """What a .pf file declares."""

    module: str = ""
    tests: list[str] = field(default_factory=list)
    around: dict[str, str] = field(default_factory=dict)


def split_arguments(text: str, line: int) -> list[str]:
    """Split what follows the name of an assertion at its commas."""
    pieces, open_brackets, quote = [""], [], ""
    for place, letter in enumerate(text):
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter in "!;":
            raise PfError(line, f"an assertion is one whole line, found '{letter}' in it")
        elif letter in CLOSES:
            open_brackets.append(CLOSES[letter])
            if len(open_brackets) == 1:
                continue
        elif letter in ")]":
            if not open_brackets or open_brackets.pop() != letter:
                raise PfError(line, f"brackets do not match at '{letter}'")
            if not open_brackets:
                if text[place + 1:].strip():
                    raise PfError(line, "an assertion is one whole line, found "
                                        f"'{text[place + 1:].strip()}' after it")
                return [] if pieces == [""] else [piece.strip() for piece in pieces]
        elif letter == "," and len(open_brackets) == 1:
            pieces.append("")
            continue
        pieces[-1] += letter
    raise PfError(line, "an assertion is one whole line, this one is not closed")


def translate_assertion(statement: str, path: Path, line: int) -> list[str]:
    """Translate one @assert."""
    found = re.fullmatch(r"@assert(\w+)\s*(\(.*)", statement, re.I)
    names = {name.lower(): name for name in ASSERTIONS}
    if not found or found[1].lower() not in names:
        raise PfError(line, f"outside the subset of pFUnit's language: '{statement}'")
    name = names[found[1].lower()]
    wanted, keywords = ASSERTIONS[name]
    arguments = split_arguments(found[2], line)
    for place, argument in enumerate(arguments):
        keyword = re.match(r"(\w+)\s*=(?![=>])", argument)
        if not argument:
            raise PfError(line, f"@assert{name} has an empty argument")
        if place < wanted and keyword:
            raise PfError(line, f"the first {wanted} of @assert{name} take no keyword, " f"found '{keyword[1]}='")
        if place >= wanted and (not keyword or keyword[1].lower() not in keywords):
            allowed = " and ".join(f"{key}=" for key in sorted(keywords)) or "nothing"
            raise PfError(line, f"after the first {wanted} @assert{name} takes {allowed}, " f"found '{argument}'")
    if len(arguments) < wanted:
        raise PfError(line, f"@assert{name} wants {wanted} arguments, found {len(arguments)}")
    call = f"  call assert{name}{found[2][:-1]}, &"
    if len(call) > LINE_LENGTH:
        raise PfError(line, f"the assertion is {len(call) - LINE_LENGTH} characters too long")
    return [f'#line {line} "{path.as_posix()}"', call,
            f" & location=SourceLocation('{path.name}', {line}))",
            "  if (anyExceptions()) return", f'#line {line + 1} "{path.as_posix()}"']


def take_subroutine(text: str, directive: str, line: int, suite: Suite) -> None:
    """Note the subroutine that a directive speaks of."""
    found = SUBROUTINE.fullmatch(text)
    if not found:
        raise PfError(line, f"the line after @{directive} is a subroutine without arguments, "
                            f"found '{text.strip()}'")
    name = found[1]
    if directive == "test":
        if not name.lower().startswith("test_"):
            raise PfError(line, f"the name of a test begins with test_, found '{name}'")
        suite.tests.append(name)
    elif directive in suite.around:
        raise PfError(line, f"there is one @{directive} in a file, found another")
    else:
        suite.around[directive] = name


def translate(source: str, path: Path) -> str:
    """Translate a .pf file."""
    suite, out, directive, line = Suite(), [f'#line 1 "{path.as_posix()}"'], "", 0
    for line, text in enumerate(source.rstrip("\n").split("\n"), start=1):
        statement = text.strip()
        module = MODULE.fullmatch(text)
        if statement.startswith("#"):
            raise PfError(line, "lines for the C preprocessor are outside the subset")
        if directive and statement and not statement.startswith("!"):
            take_subroutine(text, directive, line, suite)
            directive = ""
        elif module:
            if suite.module or module[2].strip() or module[1].lower() != path.stem.lower():
                raise PfError(line, f"the one module of this file is 'module {path.stem}', "
                                    f"alone on its line, found '{statement}'")
            suite.module = module[1]
        elif statement.startswith("@"):
            if statement.lower() in ("@test", "@before", "@after"):
                directive = statement[1:].lower()
                text = text.replace("@", "!@", 1)
            else:
                out += translate_assertion(statement, path, line)
                continue
        elif unmarked := UNMARKED.fullmatch(text):
            raise PfError(line, f"'{unmarked[3]}' has the name of a test: @test is missing above it")
        out.append(text)
    if directive or not suite.module or not suite.tests:
        missing = f"a subroutine after @{directive}" if directive else "a module and a @test"
        raise PfError(max(line, 1), f"the file ends without {missing}")
    return "\n".join(out + suite_function(suite)) + "\n"


def suite_function(suite: Suite) -> list[str]:
    """Write the function that lists the tests of a module.

    It imports and declares the names that pFUnit's own function does, so that a test module
    which makes such a name public compiles under neither.
    """
    name = f"{suite.module}_suite"
    around = "".join(f", {keyword}={suite.around[directive]}" for directive, keyword
                     in (("before", "setUp"), ("after", "tearDown")) if directive in suite.around)
    lines = ["", f"function {name}() result(suite)", "   use funit", f"   use {suite.module}",
             "   implicit none", "   type(TestSuite) :: suite", "   type(TestMethod) :: t", "",
             f"   suite = TestSuite('{name}')"]
    for test in suite.tests:
        lines += [f"   t = TestMethod('{test}', &", f"      {test}{around})", "   call suite%addTest(t)"]
    return lines + [f"end function {name}"]


def driver(modules: list[str]) -> str:
    """Write the program that runs the tests of some modules."""
    heads = "".join(f"""      function {module}_suite() result(suite)
         import :: TestSuite
         type(TestSuite) :: suite
      end function {module}_suite
""" for module in modules)
    runs = "".join(f"   call run_suite({module}_suite(), tally)\n" for module in modules)
    return f"""program run_test_suites
   use funit_runner, only : TestSuite, close_report, run_suite, tally_t
   implicit none
   interface
{heads}   end interface
   type(tally_t) :: tally

{runs}   call close_report(tally)
end program run_test_suites
"""


def read(path: Path) -> str:
    """Text of a .pf file."""
    content = path.read_bytes()
    try:
        return content.decode("utf-8").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise PfError(line, f"expected UTF-8, got the byte 0x{content[error.start]:02x}") from None


def write_new(path: Path, text: str) -> None:
    """Write a file if that changes it: what is as it was is not compiled again."""
    if not path.exists() or path.read_text("utf-8") != text:
        path.write_text(text, "utf-8")


def main() -> None:
    """Translate the files named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=Path, nargs="+", help=".pf file; with --driver several")
    parser.add_argument("output", type=Path, help="Fortran file to write")
    parser.add_argument("--driver", action="store_true", help="write the program that runs them")
    arguments = parser.parse_args()
    if arguments.driver:
        write_new(arguments.output, driver([path.stem for path in arguments.source]))
        return
    path = arguments.source[0]
    if len(arguments.source) > 1:
        parser.error("without --driver one file is translated at a time")
    try:
        write_new(arguments.output, translate(read(path), path))
    except PfError as error:
        sys.exit(f"{path}:{error.line}: error: {error}")


if __name__ == "__main__":
    main()
