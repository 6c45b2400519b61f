#!/usr/bin/env python3
"""Prints what SPIR-V modules use and clspv, the compiler of clvk (OpenCL on Vulkan), does not support (docs/porting.md). For test_spirv.sh.

    tests/tools/clspv_limits.py MODULE.spv...     needs spirv-dis (Debian: spirv-tools); exit code 1 if there is something
"""
import re, subprocess, sys

# Capabilities that kernels may require. Int8: clang copies structs as bytes. Vector16: clvk passes -long-vector to clspv.
CAPABILITIES = {"Addresses", "Linkage", "Kernel", "Vector16", "Int64", "Int8"}
# Functions of OpenCL.std that Vulkan computes exactly, or whose rounding errors raya corrects: fma, sqrt.
FUNCTIONS = {"fabs", "floor", "fma", "fmax", "fmin", "sqrt", "clz", "s_max", "u_max", "s_min", "u_min", "vloadn", "vstoren", "select"}
INSTRUCTION = re.compile(r" *(?:(%\w+) = )?Op(\w+) *(.*)")


def disassembled(file):
    """Returns [(result, instruction without "Op", operands as a list of words)] of a module."""
    text = subprocess.run(["spirv-dis", "--no-color", "--no-header", file], capture_output=True, text=True, check=True).stdout
    return [(found[1], found[2], found[3].split()) for found in map(INSTRUCTION.match, text.splitlines())]


def clspv_limits(module):
    """Returns texts on what the module uses and clspv does not support."""
    found, types, type_of, calls, function = [], {}, {}, {}, None
    for result, name, operands in module:
        if name.startswith("Type"):
            types[result] = name, operands
        elif result and operands and operands[0] in types:
            type_of[result] = operands[0]
        if name == "Capability" and operands[0] not in CAPABILITIES:
            found.append(f"capability {operands[0]}")
        elif name == "Decorate" and operands[1] == "CPacked":
            found.append(f"packed struct {operands[0]}")
        elif name == "Function":
            function = result
        elif name == "FunctionCall":
            calls.setdefault(function, set()).add(operands[1])
        elif name == "ExtInst" and operands[2] not in FUNCTIONS:
            found.append(f"function {operands[2]} of OpenCL.std")
        elif name == "Variable" and operands[1] == "CrossWorkgroup":
            found.append(f"program-scope variable {result}")
        elif name == "ConvertUToPtr" or name == "ConvertPtrToU" and types[type_of[operands[1]]][1][0] not in ("Function", "Workgroup"):
            found.append("conversion between pointer and integer")
    found += ["pointer to a pointer" for name, operands in types.values()
              if name == "TypePointer" and operands[0] != "Function" and contains_pointer(operands[1], types)]
    found += [f"recursion in {caller}" for caller in calls if caller in reached(caller, calls)]
    return sorted(set(found))


def contains_pointer(kind, types):
    name, operands = types[kind]
    members = operands if name == "TypeStruct" else operands[:1] if name == "TypeArray" else ()
    return name == "TypePointer" or any(contains_pointer(member, types) for member in members)


def reached(caller, calls):
    """Returns the functions that `caller` calls, directly or through others."""
    found, waiting = set(), [caller]
    while waiting:
        new = calls.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found


if __name__ == "__main__":
    all_texts = [f"{file}: {text}" for file in sys.argv[1:] for text in clspv_limits(disassembled(file))]
    print("\n".join(all_texts), end="\n" if all_texts else "")
    sys.exit(bool(all_texts))
