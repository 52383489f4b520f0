"""Formulas as strings: read without running code, written with all digits."""

import ast
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import sympy as sp
from sympy.printing.str import StrPrinter

from planner.numerics.arrays import Array


class Abs(sp.Abs):  # type: ignore[misc]
    """That of real numbers; sympy's own knows no slope of what may be complex."""

    def _eval_derivative(self, name: sp.Symbol) -> sp.Expr:
        return sign(self.args[0]) * self.args[0].diff(name)


class sign(sp.sign):  # type: ignore[misc]  # noqa: N801 (printed by this name)
    """Likewise."""

    def _eval_derivative(self, name: sp.Symbol) -> sp.Expr:
        return 2 * sp.DiracDelta(self.args[0]) * self.args[0].diff(name)


NAMES = "sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt"
FUNCTIONS = {n: getattr(sp, n) for n in NAMES.split()} | {"Abs": Abs, "sign": sign}
NUMERIC = {n: getattr(np, n) for n in NAMES.split()} | {"Abs": np.abs, "sign": np.sign}
CONSTANTS: Mapping[str, sp.Expr] = {"pi": sp.pi}
RESERVED = frozenset({*FUNCTIONS, *CONSTANTS})  # of which no coordinate is one
OPERATORS: Mapping[type, Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: operator.truediv, ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip
UNREADABLE = SyntaxError, TypeError, ArithmeticError, RecursionError, MemoryError
LONGEST_FORMULA = 10_000  # characters of one formula
MOST_NAMES = 100  # coordinates, and parameters, of what is read
MOST_FACTORS = 64  # in a term: each derivative makes a term of each factor
ROOM = 200  # calls around a formula that is used later, beyond those where it is read
INT64 = 2**63  # beyond the whole numbers that numpy takes
MOST_BITS = 1024  # of an integer, or of the parts of a fraction
HUGE = 1e100  # magnitude of a number; a product of three still fits a float
QUOTED = 60  # characters of a formula in a message


@dataclass(frozen=True)
class _Algebra:
    """What the parts of a formula stand for, numbers or expressions."""

    number: Callable[[float], Any]
    power: Callable[[Any, Any], Any]
    functions: Mapping[str, Callable[..., Any]]
    checked: Callable[[ast.expr, Any], Any] = lambda _, part: part

    def value(self, node: ast.expr, names: Mapping[str, Any], text: str) -> Any:
        """That of a part of a formula, with names that stand for something."""

        def part(child: ast.expr) -> Any:
            return self.checked(child, self.value(child, names, text))

        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(
                number, bool
            ):
                return self.number(number)
            case ast.Name(id=name) if name in names:
                return names[name]
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self.power(part(left), part(right))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                return OPERATORS[type(op)](part(left), part(right))
            case ast.UnaryOp(op=op, operand=operand) if type(op) in OPERATORS:
                return OPERATORS[type(op)](part(operand))
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if (
                name in self.functions and len(args) == 1 + (name == "atan2")
            ):
                return self.functions[name](*map(part, args))
        what = f"formula {_short(text)} has {_short(ast.unparse(node))}"
        called = node.func if isinstance(node, ast.Call) else None
        if isinstance(called, ast.Name) and called.id in self.functions:
            raise ValueError(f"{what}; functions take one number, atan2 takes two")
        known = ", ".join([*names, *self.functions])
        raise ValueError(f"{what}, which is neither a number nor one of {known}")


def read_formula(
    text: str | float,
    names: Iterable[sp.Symbol],
    values: Mapping[str, float] | None = None,
) -> sp.Expr:
    """The expression that a formula stands for.

    It is a number, or a text of `+ - * / **`, numbers, the functions in `FUNCTIONS`,
    the symbols in `names` and the names of `values`. Raises `ValueError` if it is no
    such formula, is too long, or has a number that is too large.
    """
    if isinstance(text, bool):
        raise ValueError(f"{text} is neither a number nor a formula")
    if isinstance(text, (int, float)):
        return sp.sympify(text)
    numbers = {name: sp.sympify(value) for name, value in (values or {}).items()}
    known = {str(s): s for s in names} | numbers | dict(CONSTANTS)
    reals = {s: np.float64(e) for s, e in known.items() if e.is_number}

    def checked(part: ast.expr, found: sp.Expr) -> sp.Expr:
        used = {node.id for node in ast.walk(part) if isinstance(node, ast.Name)}
        is_known = found.is_number and used <= {*reals, *FUNCTIONS}
        # of other numbers sympy may think for ever
        size = REAL.value(part, reals, text) if is_known else 0.0
        size = float(found) if found.is_Number else size  # however it is rounded
        if _bits(found) > MOST_BITS or not abs(size) < HUGE:
            what = f"{_short(ast.unparse(part))} has {size:g}, no real number"
            raise ValueError(f"{what} below {HUGE:.0e} in {MOST_BITS} bits")
        return found

    symbolic = _Algebra(sp.sympify, _power, FUNCTIONS, checked)
    with _read(text) as tree:
        found = symbolic.value(tree, known, text)
    large = (whole for whole in found.atoms(sp.Integer) if abs(whole) >= INT64)
    return found.xreplace({whole: sp.Float(whole) for whole in large})


def real_formula(text: str, name: str) -> Callable[[Array], Array]:
    """A formula of one name as a function of its values (T,), NaN where it is not real.

    Raises `ValueError` as `read_formula` does.
    """

    def at(values: Array) -> Array:
        with np.errstate(all="ignore"):
            found = REAL.value(tree, {name: values, "pi": np.float64(np.pi)}, text)
        return np.broadcast_to(found, values.shape)

    with _read(text) as tree:
        _deeper(ROOM, partial(at, np.zeros(1)))
    return at


def _deeper(calls: int, function: Callable[[], Array]) -> Array:
    """What a function returns that is called with so many calls around it."""
    return _deeper(calls - 1, function) if calls else function()


@contextmanager
def _read(text: str) -> Iterator[ast.expr]:
    """The tree of a formula; `ValueError` for what cannot be read of it."""
    if (n := len(text)) > LONGEST_FORMULA:
        raise ValueError(f"formula is {n} characters long, {LONGEST_FORMULA} at most")
    try:
        tree = ast.parse(text.strip(), mode="eval").body
        if (count := _factors(tree)) > MOST_FACTORS:
            what = f"formula {_short(text)} has a term of {count} factors"
            raise ValueError(f"{what}, nested ones among them; {MOST_FACTORS} at most")
        with np.errstate(all="ignore"):
            yield tree
    except UNREADABLE as error:
        why = getattr(error, "msg", error)  # of a SyntaxError without its place
        raise ValueError(f"formula {_short(text)} cannot be read: {why}") from None


def _short(text: str) -> str:
    return repr(text if len(text) <= QUOTED else f"{text[: QUOTED - 3]}...")


def _factors(node: ast.expr) -> int:
    """Numbers, names and functions in the longest term and in what is nested in it."""
    parts = (n for n in ast.iter_child_nodes(node) if isinstance(n, ast.expr))
    is_sum = isinstance(getattr(node, "op", None), ast.Add | ast.Sub)
    return (max if is_sum else sum)(map(_factors, parts)) or 1


def _bits(part: sp.Expr) -> int:
    whole = (n for r in part.atoms(sp.Rational) for n in (r.p, r.q))
    return max((int(n).bit_length() for n in whole), default=0)


def _power(base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    """A power, unless sympy would multiply it out to a number of enormous length."""
    if exponent.is_Rational and _bits(base) * abs(exponent) > MOST_BITS:
        what = _short(str(base))
        raise ValueError(f"{what} to the power {exponent} is too large a number")
    return base**exponent


REAL = _Algebra(np.float64, operator.pow, NUMERIC)


class _Writer(StrPrinter):  # type: ignore[misc]
    """Prints floats with all their digits."""

    def _print_Float(self, number: sp.Float) -> str:  # noqa: N802
        return repr(float(number))


def write_formula(expression: sp.Expr) -> str:
    """The string that `read_formula` turns into the same expression."""
    return str(_Writer().doprint(expression))
