"""The study of the estimate: effectivities where the truth is known, accuracies that were asked for."""

from __future__ import annotations

from itertools import chain

import numpy as np
import pytest
from error_known import Case, adapted, groove, manufactured, measured, press_fit
from test_demos import is_picture, run


@pytest.mark.parametrize(
    "case", [groove(8, 1), groove(8, 2), manufactured(8, 1, 2), press_fit(2, 1), press_fit(2, 2)], ids=lambda c: c.name
)
def test_effectivity(case: Case):
    row = measured(case)
    assert 0.5 < row["effectivity"] < 2.5
    assert row["cost"] > 0


def test_press_fit_is_exact_in_the_limit():
    """The closed form is what the elements converge to, at the order of degree 2."""
    errors = [measured(press_fit(n, 2))["true_error"] for n in (2, 4)]
    assert np.log2(errors[0] / errors[1]) > 2.7


def test_adapted():
    rows = adapted(2, [2e-3])
    assert rows[-1]["status"] == "reached"
    assert rows[-1]["true_error"] < 2 * 2e-3


@pytest.mark.long
def test_error_known(tmp_path):
    summary = run("studies/error_known", tmp_path, "--quick")
    told = [row["effectivity"] for row in summary["rows"]]
    assert all(0.5 < each < 2.5 for each in told)
    assert 0.7 < summary["median_effectivity"] < 1.4
    assert all(1.0 <= row["effectivity"] < 2.0 for row in summary["bounds"])
    for row in chain(*summary["adapted"]):
        assert row["true_error"] < 2 * row["accuracy"]
    assert is_picture(tmp_path / "error_known.png")
