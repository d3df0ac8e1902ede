"""What the figures of the stability studies say about made-up records."""
import importlib
import math

import pytest

FIXED = {"particles": 1, "vertices": 1, "contact_rule": "features", "law": "spring-dashpot", "control": "fixed", "steps_per_contact": 50.3}


def metric(value, bar=None) -> dict:
    return {"value": value, "bar": bar, "within": None if bar is None else value is not None and abs(value) <= bar}


def sweep(made_up, name: str, axes: dict, metrics_of) -> None:
    """Records whose metrics are metrics_of(params)."""
    for point in made_up.sweep(name, {"seed": [1], **axes}, FIXED).values():
        made_up.change(name, point["id"], metrics=metrics_of(point["params"]))


def draw(made_up, name: str):
    return importlib.import_module(name).draw(made_up.folder, made_up.folder / "figures")


def test_medians_are_over_seeds_and_one_failure_fails_the_value(made_up):
    stability, records = importlib.import_module("stability"), importlib.import_module("records")
    values = {(1, 1): 3.0, (1, 2): 5.0, (1, 3): 100.0, (2, 1): 1.0, (2, 2): None, (2, 3): 1.0}
    sweep(made_up, "stability_rest", {"seed": [1, 2, 3], "study": ["long-rest"], "value": [1, 2]},
          lambda p: {"drift_m": metric(values[p["value"], p["seed"]], 4.0)})
    loaded = records.load_sweep(made_up.folder, "stability_rest")
    line = stability.Line("", "long-rest", "drift_m")
    assert stability.found(loaded, line, "value") == [(1, 5.0, 4.0), (2, None, 4.0)]
    assert stability.worst(loaded, line) == math.inf
    assert len(stability.outside(loaded)) == 3  # 5, 100 and the failure


def test_a_rule_holds_a_bar_only_if_it_does_at_every_cut(made_up):
    module = importlib.import_module("stability_rules")

    def metrics(params: dict) -> dict:
        names = [name for study, name in module.BARS if study == params["study"]] + ["loop_work_at_2500_points", "microseconds"]
        bad = params["contact_rule"] == "dedupe" and params["value"] == 4
        return {name: metric(1.0 if bad else 0.0, 1e-6) for name in names}

    sweep(made_up, "stability_rules", {"study": ["tessellation", "loop-work", "face-rest", "stack", "rule-cost"],
                                       "contact_rule": list(module.RULES), "value": [2, 4]}, metrics)
    notes = draw(made_up, "stability_rules").notes
    bars = len(module.BARS)
    assert f"dedupe holds 0 of {bars} bars." in notes and f"features holds {bars} of {bars} bars." in notes


def test_a_critical_step_out_of_its_bar_is_counted(made_up):
    def metrics(params: dict) -> dict:
        return {"textbook_over_observed": metric(2.45),
                **{f"observed_over_predicted_at_damping_{z}_percent": metric(1.1) for z in (0, 30, 80)},
                "outside_0.95_to_1.02_at_damping_0_percent": metric(0.08 if params["value"] == 5 else 0.0, 0.0)}

    sweep(made_up, "stability_critical_step", {"study": ["critical-step"], "value": [1, 2, 5]}, metrics)
    assert "1 of the observed steps are outside" in draw(made_up, "stability_critical_step").notes[0]


@pytest.mark.parametrize("outcome,said", [(1, "0 fail"), (2, "1 fail: open")])
def test_a_mesh_that_fails_is_named(made_up, outcome, said):
    sweep(made_up, "stability_degenerate", {"study": ["degenerate"], "value": [1]}, lambda _: {"open_moving": metric(outcome, 1)})
    assert draw(made_up, "stability_degenerate").notes[0].startswith(said)


def test_a_panel_of_which_nothing_was_run_says_so(made_up):
    sweep(made_up, "stability_rebound", {"study": ["rebound"], "steps_per_contact": [20, 40], "value": [1]},
          lambda params: {name: metric(1 / params["steps_per_contact"] ** 2) for name in ("restitution_error", "mean_restitution_error")})
    draw(made_up, "stability_rebound")
    assert (made_up.folder / "figures/stability_rebound.svg").read_text().count(">not run<") == 2


def test_the_law_of_discharge_is_found_and_how_low_a_bin_may_sink(made_up):
    module = importlib.import_module("figure_beverloo")

    def metrics(params: dict) -> dict:
        flow = (params["value"] - 1.4)**2.5 * module.DENSITY * math.sqrt(module.GRAVITY) * 0.01**2.5 * (1 + 0.001 * params["seed"])
        if params["study"] == "discharge":
            own = {"rate_kg_s": flow, "rate_change": -0.01, "level_of_opening": 1.3}
        else:
            own = {f"rate_kg_s_{left}": flow * (1 if left > 50 else 0.9) for left in module.LEFT}
            own |= {f"level_of_opening_{left}": left / 50 for left in module.LEFT}
        return {name: metric(value) for name, value in {**own, "grain_diameter_m": 0.01}.items()}

    axes = {"study": ["discharge", "emptying"], "vertices": [0], "value": [5, 6, 7], "stiffness": [1, 4]}
    sweep(made_up, "figure_beverloo", axes | {"seed": [1]}, metrics)
    assert "nan" not in " ".join(draw(made_up, "figure_beverloo").notes), "one seed has no error"
    sweep(made_up, "figure_beverloo", axes | {"seed": [1, 2]}, metrics)
    notes = " ".join(draw(made_up, "figure_beverloo").notes)
    assert "flow stops at D = 1.40 d" in notes and "R2 = 1.0000" in notes
    assert "changes by -1.0 +- 0.0 % at most" in notes
    assert "springs 4 times as stiff the mean flow at D = 6 d changes by +0.0" in notes
    assert "D = 6 d: while the bin empties the flow stays within 3 % of that of a full one down to 50 %" in notes
    assert "left out" not in notes
    sweep(made_up, "figure_beverloo", axes | {"seed": [1, 2]}, lambda p: metrics(p) | {"fast_contacts": metric(p["seed"] - 1, 0)})
    notes = " ".join(draw(made_up, "figure_beverloo").notes)
    assert "1 seed per opening" in notes and "12 of 24 runs missed a bar of soundness and are left out (fast contacts in 12)" in notes
