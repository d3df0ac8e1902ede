"""JSON Schema of specs, made from the programs' tables of parameters; kept in experiments/schema/spec.json."""
from typing import Any

from sweep.aliases import KEYS, VALUES
from sweep.parameters import PROGRAMS, Parameter, Program

Schema = dict[str, Any]
TYPES = {str: "string", int: "integer", float: "number"}
SHARED: Schema = {
    "time_limit_s": {"description": "a process that takes longer (s) is stopped and its point recorded as failed",
                     "type": "number", "exclusiveMinimum": 0},
    "memory_limit_mb": {"description": "address space (MB) of a point's process; none if not given", "type": "number",
                        "exclusiveMinimum": 0},
    "range": {"type": "object", "additionalProperties": False, "required": ["from", "to"],
              "description": "from, from + step, ... or from, from x factor, ... up to and including to",
              "properties": {"from": {"type": "number"}, "to": {"type": "number"},
                             "step": {"type": "number", "exclusiveMinimum": 0},
                             "factor": {"type": "number", "exclusiveMinimum": 1}},
              "oneOf": [{"required": ["step"]}, {"required": ["factor"]}]},
    "text": {"type": "string", "minLength": 1},
    "elsewhere": {"description": "panels that need another kind of machine; listed, never run", "type": "array",
                  "items": {"type": "object", "additionalProperties": False, "required": ["what", "needs"],
                            "properties": {"what": {"type": "string"}, "needs": {"type": "string"}}}},
}
LISTS = {"type": ["array", "object"], "uniqueItems": True}


def spec_schema() -> Schema:
    """The whole schema: each program has specs of its own; without "program" it is dem_bench's."""
    first, *others = PROGRAMS
    named = [{"if": {"required": ["program"], "properties": {"program": {"const": name}}},
              "then": {"$ref": f"#/$defs/{name}"}} for name in others]
    default = {"if": {"properties": {"program": {"const": first}}}, "then": {"$ref": f"#/$defs/{first}"}}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "Spec of a sweep",
            "description": "Which points an experiment has. The file's name is the name of the sweep and of its folder in "
                           "results/. Made by `sweep schema`.",
            "type": "object",
            "properties": {"program": {"description": "the program that runs a point", "enum": list(PROGRAMS)}},
            "allOf": [default, *named],
            "$defs": {**SHARED, **{name: _spec(program) for name, program in PROGRAMS.items()}}}


def _spec(program: Program) -> Schema:
    here = f"#/$defs/{program.name}/$defs"
    ref = {key: {"$ref": f"{here}/{key}"} for key in ("fixed", "axes", "zip", "exclude", "prepare", "name", "choices")}
    shared = {key: {"$ref": f"#/$defs/{key}"} for key in ("time_limit_s", "memory_limit_mb")}
    varied = {key: ref[key] for key in ("fixed", "axes", "zip", "exclude")} | shared
    preset = {"type": "object", "additionalProperties": False,
              "properties": {**varied, "prepare": {"anyOf": [ref["prepare"], {"type": "null"}]}}}
    return {
        "type": "object", "additionalProperties": False,
        "properties": {
            "title": {"type": "string"}, "about": {"type": "string"}, "program": True, **varied,
            "interleave": {"description": "points that differ in these parameters alone are compared: their repeats are "
                                          "processes that take turns", "type": "array", "items": ref["name"]},
            "prepare": {"allOf": [ref["prepare"], {"required": ["by", "end_s"]}]},
            "trace": {"description": "keep the work of every thread of every point as RESULTS/SPEC/traces/ID.json, in Chrome's "
                                     "trace format", "type": "boolean"},
            "expected_failures": {"description": "points that meet all of `where` are baselines whose `check` fails, and why: "
                                                 "they are shown as such and are no defect", "type": "array",
                                  "items": {"type": "object", "additionalProperties": False, "required": ["where", "check", "why"],
                                            "properties": {"where": {"allOf": [ref["choices"], {"minProperties": 1}]},
                                                           "check": {"$ref": "#/$defs/text"}, "why": {"$ref": "#/$defs/text"}}}},
            "elsewhere": {"$ref": "#/$defs/elsewhere"},
            "presets": {"description": "changes to the spec by name: --quick, --full, --preset NAME; full without an entry "
                                       "is the spec itself", "type": "object", "additionalProperties": preset}},
        "$defs": {
            "name": {"enum": list(program.parameters)},
            "fixed": {"description": "one value for every point",
                      "allOf": [ref["choices"], {"additionalProperties": {"type": ["string", "number"]}}]},
            "axes": {"description": "every combination of these values is a point; the last axis varies fastest",
                     "allOf": [ref["choices"], {"additionalProperties": LISTS}]},
            "zip": {"description": "groups of lists of one length that advance together; each row of each group is combined "
                                   "with all else", "type": "array",
                    "items": {"allOf": [ref["choices"], {"minProperties": 2, "additionalProperties": {"type": LISTS["type"]}}]}},
            "exclude": {"description": "a point that meets all of one of these conditions (a value, or one of a list) is left "
                                       "out", "type": "array", "items": {"allOf": [ref["choices"], {"minProperties": 1}]}},
            "prepare": {"description": "start states: each distinct combination of the parameters `by` is run once with "
                                       "`params` until end_s (s), and its points start from there", "type": "object",
                        "additionalProperties": False,
                        "properties": {"by": {"type": "array", "minItems": 1, "items": ref["name"]}, "params": ref["fixed"],
                                       "end_s": {"type": "number", "minimum": 1e-9}}},
            "parameters": {key: _value(parameter) for key, parameter in program.parameters.items()},
            "choices": {"description": "a value, a list of values or a range, by parameter; the ancestor's names are accepted",
                        "type": "object", "additionalProperties": False, "properties": _choices(program, here)}}}


def _value(parameter: Parameter) -> Schema:
    schema: Schema = {"type": TYPES[parameter.kind]}
    if parameter.names:
        schema["enum"] = list(parameter.names)
    elif parameter.kind is str:
        schema["minLength"] = 1
    return schema if parameter.kind is str else {**schema, "minimum": parameter.least}


def _choices(program: Program, here: str) -> Schema:
    choices: Schema = {}
    for key, parameter in program.parameters.items():
        one: Schema = {"$ref": f"{here}/parameters/{key}"}
        if key in VALUES:
            one = {"anyOf": [one, {"enum": list(VALUES[key])}]}
        ranges = [] if parameter.kind is str else [{"$ref": "#/$defs/range"}]
        choices[key] = {"anyOf": [one, {"type": "array", "minItems": 1, "items": one}, *ranges]}
    former = {old: {"$ref": f"{here}/choices/properties/{new}"} for old, new in KEYS.items() if new in choices}
    return {**choices, **former}
