"""Write the module funit: pFUnit's assertions, one short subroutine for each kind and rank."""

import argparse
import itertools
from pathlib import Path

#: Fortran type of each kind of argument.
TYPES = {"int": "integer", "long": "integer(int64)", "single": "real",
         "double": "real(real64)", "text": "character(len=*)", "truth": "logical"}
WIDEN = {"int": "int({}, int64)", "single": "real({}, real64)"}  #: The widest of a kind: what the comparisons take.
RANKS = ((0, 0), (0, 1), (1, 1), (0, 2), (2, 2))  #: Ranks of the first and of the second argument.
ORDERS = ("LessThan", "LessThanOrEqual", "GreaterThan", "GreaterThanOrEqual")
#: Words that pFUnit makes public: a test module that declares one does not compile there.
TAKEN = ("catch", "disable", "every", "expectation", "false", "finalize", "initialize", "is",
         "near", "predicate", "run", "stub", "subject", "test", "testcase", "testresult",
         "testrunner", "throw", "true")

HEAD = """!> The assertions of a .pf file; written by make_funit.py
module funit
   use, intrinsic :: iso_fortran_env, only : int64, real64
   use funit_compare, only : claim, judge, judge_truth
   use funit_runner, only : SourceLocation, TestMethod, TestSuite, anyExceptions, record_failure
   implicit none
   private

   public :: SourceLocation, TestMethod, TestSuite, anyExceptions
"""
PROCEDURE = """
   subroutine {name}({names}, message, location)
{declarations}
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in) :: location

      call {judge}
   end subroutine {name}
"""
FAIL = """
   subroutine fail_always(message, location)
      character(len=*), intent(in) :: message
      type(SourceLocation), intent(in) :: location

      call record_failure(location, "AssertFail", [message])
   end subroutine fail_always
"""


def declare(kind: str, name: str, rank: int = 0, attribute: str = "") -> str:
    """Declare a dummy argument."""
    shape = f"({', '.join(':' * rank)})" if rank else ""
    return f"      {TYPES[kind]}, intent(in){attribute} :: {name}{shape}"


def as_list(kind: str, name: str, rank: int) -> str:
    """Write an argument as a list of the widest kind, in array element order."""
    wide = WIDEN.get(kind, "{}").format(name)
    return {0: f"[{wide}]", 1: wide, 2: f"reshape({wide}, [size({name})])"}[rank]


def comparison(assertion: str, kinds: tuple[str, str], ranks: tuple[int, int], tolerance: str = "") -> tuple[str, str]:
    """Write an assertion on two arguments."""
    name = f"{assertion.lower()}_{'_'.join(kinds)}_{ranks[0]}{ranks[1]}_{tolerance}".rstrip("_")
    names = "expected, actual"
    declarations = [declare(kinds[0], "expected", ranks[0]), declare(kinds[1], "actual", ranks[1])]
    number = kinds == ("int", "double")
    judge = (f'judge(claim("Assert{assertion}", message, location), &\n         '
             f'{as_list("single" if number else kinds[0], "expected", ranks[0])}, '
             f'shape(expected), &\n         {as_list(kinds[1], "actual", ranks[1])}, shape(actual)')
    if tolerance:
        names += ", tolerance"
        may_be_absent = tolerance == "double" and assertion != "RelativelyEqual"
        declarations.append(declare(tolerance, "tolerance", attribute=", optional" if may_be_absent else ""))
        judge += ", " + WIDEN.get(tolerance, "{}").format("tolerance")
    return name, PROCEDURE.format(name=name, names=names, judge=judge + ")", declarations="\n".join(declarations))


def condition(assertion: str, rank: int) -> tuple[str, str]:
    """Write AssertTrue or AssertFalse."""
    name = f"{assertion.lower()}_{rank}"
    judge = (f'judge_truth(claim("Assert{assertion}", message, location), '
             f'{as_list("truth", "condition", rank)}, .{assertion.lower()}.)')
    return name, PROCEDURE.format(name=name, names="condition", judge=judge,
                                  declarations=declare("truth", "condition", rank))


def assertions() -> dict[str, list[tuple[str, str]]]:
    """List every overload of every assertion."""
    overloads = {}
    for assertion in ("Equal", "RelativelyEqual", *ORDERS):
        reals = itertools.product(("int", "single", "double"), RANKS, ("single", "double"))
        overloads[assertion] = [comparison(assertion, (kind, "double"), ranks, tolerance)
                                for kind, ranks, tolerance in reals]
    for assertion in ("Equal", *ORDERS):
        pairs = (("int", "int"), ("int", "long"), ("long", "long"))
        overloads[assertion] += [comparison(assertion, kinds, ranks)
                                 for kinds, ranks in itertools.product(pairs, RANKS)]
    overloads["Equal"] += [comparison("Equal", ("text", "text"), ranks) for ranks in RANKS[:3]]
    for assertion in ("True", "False"):
        overloads[assertion] = [condition(assertion, rank) for rank in (0, 1)]
    overloads["Fail"] = [("fail_always", FAIL)]
    return overloads


def module_text() -> str:
    """Write the whole module."""
    text = HEAD + "".join(f"   integer, parameter, public :: {word} = 0\n" for word in TAKEN)
    overloads = assertions()
    for assertion, procedures in overloads.items():
        text += f"\n   interface assert{assertion}\n"
        text += "".join(f"      module procedure {name}\n" for name, _ in procedures)
        text += f"   end interface assert{assertion}\n   public :: assert{assertion}\n"
    bodies = (body for procedures in overloads.values() for _, body in procedures)
    return text + "\ncontains\n" + "".join(bodies) + "end module funit\n"


def main() -> None:
    """Write the module to the file named on the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=Path, help="Fortran file to write")
    parser.parse_args().output.write_text(module_text(), encoding="utf-8")


if __name__ == "__main__":
    main()
