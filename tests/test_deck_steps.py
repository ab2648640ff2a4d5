"""What cards of later steps replace, and tables of time that cannot be meant."""

from __future__ import annotations

import pytest
from test_deck_amplitudes import LINEAR, with_amplitude
from test_deck_scene import M, cubes

import contactdd as cd

AGAIN = "*STEP\n*STATIC\n{}*END STEP\n"
SERIES = 1 / (1 / M + 1 / 4e5)


@pytest.mark.parametrize(
    "second",
    [
        "*CLOAD, OP=NEW\nUPPER_BELOW, 3, -0.25\n",
        "*CLOAD, OP=NEW\n9, 3, -0.25\n10, 3, -0.25\n*CLOAD, OP=NEW\n11, 3, -0.25\n12, 3, -0.25\n",
        "*CLOAD, OP=NEW\nUPPER_BELOW, 3, -0.1\n*CLOAD, OP=NEW\nUPPER_BELOW, 3, -0.15\n",
        "*CLOAD\nUPPER_BELOW, 3, -0.25\n*CLOAD, OP=NEW\nUPPER_ABOVE, 3, 0.\n",
    ],
    ids=["one card", "half of the nodes each", "two that add up", "only the first card of a step counts"],
)
def test_new_loads_replace_those_of_earlier_steps(tmp_path, second):
    """1 = F + k₂ u₂, F = k₁ u₁ = k (u₂ − u₁): the second step's four forces of a quarter, none of the first's."""
    deck = cubes(LINEAR, "*CLOAD\nUPPER_BELOW, 3, -5.\n").add(AGAIN.format(second))
    solution = cd.solve(cd.read_scene(deck.write(tmp_path)))
    assert solution.contact().force == pytest.approx(SERIES / (SERIES + 0.2 * M), rel=1e-6)


@pytest.mark.parametrize("table", ["1., 1., 0., 0.\n", "", "0., 0., 1., nan\n"])
def test_tables_of_time_that_cannot_be_meant(tmp_path, table):
    deck = with_amplitude(cubes(LINEAR, "*CLOAD, AMPLITUDE=A\nUPPER_BELOW, 3, -1.\n"), f"\n{table}")
    with pytest.raises(ValueError, match=r"\*AMPLITUDE that cannot be read \(expected pairs of a time and a factor"):
        cd.read_scene(deck.write(tmp_path))
