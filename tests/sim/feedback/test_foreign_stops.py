"""The stops in a stranger's feedback.csv are refused where no walk has them."""

import pytest

from sim.feedback.stops import Stop, read, written

POSE = (0.1, 0.2, 0.3)
NOTHING = (float("nan"),) * 4
STOPS = [Stop(n, n + 1.0, 1.0, POSE, NOTHING, *[POSE] * 6) for n in range(2)]


def test_stops_come_through_a_file_as_they_are():
    assert str(read(written(STOPS))) == str(tuple(STOPS))


@pytest.mark.parametrize("key", ["meant", "seen", "doubt", "thought", "true", "bias"])
@pytest.mark.parametrize("number", [1e300, float("-inf")])
def test_a_stop_with_a_number_too_large_is_refused(key, number):
    pose = (number, *getattr(STOPS[1], key)[1:])
    with pytest.raises(ValueError, match="impossible stop 1"):
        read(written([STOPS[0], STOPS[1]._replace(**{key: pose})]))


@pytest.mark.parametrize(
    "changed",
    [
        {"segment": 5}, {"segment": 1.5}, {"time": float("nan")}, {"time": 1.0},
        {"time": -5.0}, {"seconds": -8.0}, {"doubt": (-1.0, 0.0, 0.0)},
        {"claimed": (0.0, 0.0, -1.0)},
    ],
    ids=str,
)  # fmt: skip
def test_a_stop_that_cannot_follow_the_one_before_is_refused(changed):
    with pytest.raises(ValueError, match=r"^feedback\.csv has an impossible stop 1$"):
        read(written([STOPS[0], STOPS[1]._replace(**changed)]))


def test_a_word_for_a_number_is_refused_with_its_file_and_row():
    text = written(STOPS).replace("2.0,1.0,", "x,1.0,")
    with pytest.raises(ValueError, match=r"^feedback\.csv has an impossible stop 1$"):
        read(text)


def test_only_what_was_seen_may_be_missing():
    with pytest.raises(ValueError, match="impossible stop 1"):
        read(written([STOPS[0], STOPS[1]._replace(bias=NOTHING[:3])]))
