"""Formulas as strings: read without running code, written with all digits."""

import ast
import operator
from collections.abc import Callable, Iterable, Mapping

import sympy as sp
from sympy.printing.str import StrPrinter

NAMES = "sin cos tan asin acos atan atan2 sinh cosh tanh exp log sqrt Abs sign"
FUNCTIONS = {name: getattr(sp, name) for name in NAMES.split()}
CONSTANTS: Mapping[str, sp.Expr] = {"pi": sp.pi}
RESERVED = frozenset({*FUNCTIONS, *CONSTANTS})  # names that coordinates cannot have
OPERATORS: Mapping[type, Callable[..., sp.Expr]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: operator.truediv, ast.USub: operator.neg, ast.UAdd: operator.pos,
    ast.Pow: lambda base, exponent: _power(base, exponent),
}  # fmt: skip
UNREADABLE = SyntaxError, TypeError, ArithmeticError, RecursionError, MemoryError
LONGEST_FORMULA = 10_000  # characters of one formula
MOST_FACTORS = 64  # in a term: each derivative makes a term of each factor
MOST_BITS = 1024  # of an integer, or of the parts of a fraction
HUGE = 1e100  # magnitude of a number; a product of three still fits a float
QUOTED = 60  # characters of a formula in a message


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
    if (n := len(text)) > LONGEST_FORMULA:
        raise ValueError(f"formula is {n} characters long, {LONGEST_FORMULA} at most")
    numbers = {name: sp.sympify(value) for name, value in (values or {}).items()}
    known = {str(s): s for s in names} | numbers | dict(CONSTANTS)
    try:
        tree = ast.parse(text.strip(), mode="eval").body
        if (count := _factors(tree)) > MOST_FACTORS:
            what = f"formula {_short(text)} has a term of {count} factors"
            raise ValueError(f"{what}, nested ones among them; {MOST_FACTORS} at most")
        return _expression(tree, known, text)
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


def _expression(node: ast.expr, names: Mapping[str, sp.Expr], text: str) -> sp.Expr:
    def part(child: ast.expr) -> sp.Expr:  # sympy works for ever on some large numbers
        inner = _expression(child, names, text)
        size = abs(inner).evalf() if inner.is_number else sp.S.Zero
        if _bits(inner) > MOST_BITS or (size.is_finite and size >= HUGE):
            what = f"{_short(ast.unparse(child))} has {float(size)}, no real number"
            raise ValueError(f"{what} below {HUGE:.0e} in {MOST_BITS} bits")
        return inner

    match node:
        case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
            return sp.sympify(node.value)
        case ast.Name(id=name) if name in names:
            return names[name]
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            return OPERATORS[type(op)](part(left), part(right))
        case ast.UnaryOp(op=op, operand=operand) if type(op) in OPERATORS:
            return OPERATORS[type(op)](part(operand))
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if (
            name in FUNCTIONS
        ):
            return FUNCTIONS[name](*map(part, args))
    what = f"formula {_short(text)} has {_short(ast.unparse(node))}"
    known = ", ".join([*names, *FUNCTIONS])
    raise ValueError(f"{what}, which is neither a number nor one of {known}")


class _Writer(StrPrinter):  # type: ignore[misc]
    """Prints floats with all their digits."""

    def _print_Float(self, number: sp.Float) -> str:  # noqa: N802
        return repr(float(number))


def write_formula(expression: sp.Expr) -> str:
    """The string that `read_formula` turns into the same expression."""
    return str(_Writer().doprint(expression))
