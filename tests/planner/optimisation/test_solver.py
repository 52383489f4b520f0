"""IPOPT ends early when it is told to, and says so."""

import os
import signal
import threading

import casadi as ca
import numpy as np
import pytest
import sympy as sp

from planner.errors import BudgetError
from planner.optimisation.solver import Ipopt, casadi_function
from planner.support.stopping import limited
from planner.systems.formulas import read_formula

SIZE = 400


def rosenbrock():
    """A valley along which IPOPT takes hundreds of small steps."""
    x = ca.MX.sym("x", SIZE)
    valley = sum(100 * (x[i + 1] - x[i] ** 2) ** 2 for i in range(SIZE - 1))
    return Ipopt({"x": x, "f": valley + ca.sumsqr(1 - x), "g": ca.sumsqr(x)})


def solved(ipopt, most=np.inf):
    return ipopt(x0=-1.2 * np.ones(SIZE), lbg=np.array([-np.inf]), ubg=np.array([most]))


@pytest.fixture(params=[signal.SIGINT, signal.SIGXCPU])
def raised(request):
    """A signal that raises KeyboardInterrupt, as all do that end a command."""
    before = signal.signal(request.param, signal.default_int_handler)
    yield request.param
    signal.signal(request.param, before)


def interrupted(raised):
    """Solve until a signal ends it."""
    ipopt = rosenbrock()
    arrives = threading.Timer(0.1, os.kill, (os.getpid(), raised))
    arrives.start()
    with pytest.raises(KeyboardInterrupt):
        any(solved(ipopt) for _ in range(1000))  # until it has arrived


def test_a_signal_during_a_solution_is_not_lost_nor_told_by_a_library(raised, capfd):
    interrupted(raised)
    assert signal.getsignal(raised) is signal.default_int_handler
    assert capfd.readouterr().err == ""


def test_a_signal_during_a_solution_arrives_once(raised):
    """A second one would be taken for another Ctrl-C."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    before = signal.set_wakeup_fd(writer)
    try:
        interrupted(raised)
    finally:
        signal.set_wakeup_fd(before)
        os.close(writer)
    assert os.read(reader, 9) == bytes([raised])
    os.close(reader)


def test_the_time_to_plan_in_holds_during_a_solution():
    with pytest.raises(BudgetError), limited(1e-9):
        solved(rosenbrock())


def test_options_that_lie_in_the_working_folder_are_not_obeyed(tmp_path, monkeypatch):
    """Which name files that are written, and libraries whose code is run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ipopt.opt").write_text(f"output_file {tmp_path / 'written'}\n")
    x = ca.MX.sym("x")
    assert Ipopt({"x": x, "f": x**2, "g": x})(x0=np.ones(1)) is not None
    assert not (tmp_path / "written").exists()


@pytest.mark.parametrize("text", ["sign(x + 2)*x", "Abs(log(x + 3))", "atan2(x, 2)**2"])
def test_formulas_are_the_same_in_the_solver_s_symbols(text):
    x, given = sp.Symbol("x", real=True), ca.SX.sym("x", 1)
    expression = read_formula(text, [x])
    (made,) = casadi_function((x,), (expression,))(given)
    for value in (-2.5, 0.0, 0.7):
        found = float(ca.Function("f", [given], [made])(value))
        assert found == pytest.approx(float(expression.subs(x, value)), rel=1e-14)


def test_a_program_without_a_solution_has_none():
    x = ca.MX.sym("x")
    ipopt = Ipopt({"x": x, "f": x, "g": x**2})
    assert ipopt(x0=np.ones(1), lbg=-np.ones(1), ubg=-np.ones(1)) is None


def test_an_error_is_not_remembered_by_the_next_solution():
    x = ca.MX.sym("x")
    ipopt = Ipopt({"x": x, "f": (x - 2) ** 2, "g": x})
    bounds = {"x0": np.ones(1), "lbg": np.zeros(1), "ubg": np.ones(1)}
    with pytest.raises(BudgetError), limited(1e-9):
        ipopt(**bounds)
    assert float(ipopt(**bounds)["x"]) == pytest.approx(1.0, abs=1e-6)
