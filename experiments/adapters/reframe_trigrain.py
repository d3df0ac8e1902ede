"""Sweeps under ReFrame: reframe -c experiments/adapters/reframe_trigrain.py -r; -S spec=figure_8_8 for another one.
The sweep decides what is run and checks the answers; ReFrame starts it and keeps the median times."""
import json
import statistics
from pathlib import Path

import reframe as rfm
import reframe.utility.sanity as sn

CHECKOUT = str(Path(__file__).resolve().parents[2])


@rfm.simple_test
class TrigrainSweep(rfm.RunOnlyRegressionTest):
    """One spec with one of its presets."""

    spec = variable(str, value="figure_8_5")  # noqa: F821: names that ReFrame gives to the bodies of its classes
    preset = parameter(["smoke"])  # noqa: F821
    trigrain = variable(str, value=CHECKOUT)  # noqa: F821
    valid_systems = ["*"]
    valid_prog_environs = ["*"]

    @run_before("run")  # noqa: F821
    def commands(self):
        sweep = f"{self.trigrain}/build/release/bin/sweep"
        self.executable = sweep
        self.executable_opts = ["run", self.spec, "--preset", self.preset, "--results", "results"]
        self.postrun_cmds = [f"{sweep} export {self.spec} --preset {self.preset} --results results --format jsonl "
                             "--out samples.jsonl"]

    @sanity_function  # noqa: F821
    def every_point_finished(self):
        """The last line counts the points; failed ones would be named there."""
        return sn.all([sn.assert_found(r"\d+ finished", self.stdout),
                       sn.assert_not_found(r"check failed|\d+ failed|\d+ missing$", self.stdout)])

    @performance_function("us")  # noqa: F821
    def step(self):
        """Median wall time of a step over all points and samples."""
        with open(f"{self.stagedir}/samples.jsonl", encoding="utf-8") as file:
            samples = [json.loads(line) for line in file]
        return statistics.median(1e6 * sample["wall_s"] / sample["steps"] for sample in samples)
