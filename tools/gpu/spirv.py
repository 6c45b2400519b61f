"""SPIR-V modules: double precision, undefined functions, and uses of what clspv, the compiler of clvk (OpenCL on Vulkan), does not support.

    python3 tools/gpu/spirv.py MODULE.spv...     prints what clspv does not support (docs/porting.md); exit code 1 if there is something
"""
import struct, sys
from pathlib import Path

# Capabilities that kernels may require. Int8: clang copies structs as bytes. Vector16: clvk passes -long-vector to clspv.
CAPABILITIES = {4: "Addresses", 5: "Linkage", 6: "Kernel", 7: "Vector16", 11: "Int64", 39: "Int8"}
# Functions of OpenCL.std that Vulkan computes exactly, or whose rounding errors raya corrects: fma, sqrt.
FUNCTIONS = {23: "fabs", 25: "floor", 26: "fma", 27: "fmax", 28: "fmin", 61: "sqrt", 151: "clz", 156: "s_max", 157: "u_max", 158: "s_min",
             159: "u_min", 171: "vloadn", 172: "vstoren", 187: "select"}
FUNCTION, WORKGROUP, CROSS_WORKGROUP = 7, 4, 5  # storage classes: private, local and global memory


def instructions(code):
    """Yields (opcode, operands as a tuple of words) of each instruction."""
    words = struct.unpack(f"<{len(code) // 4}I", code)
    position = 5
    while position < len(words):
        length = words[position] >> 16
        yield words[position] & 0xFFFF, words[position + 1:position + length]
        position += length


def text_of(words):
    return struct.pack(f"<{len(words)}I", *words).split(b"\0")[0].decode()


def faults_of(code):
    """Returns texts on the faults in a SPIR-V module: double precision, and undefined functions."""
    found = []
    for operation, operands in instructions(code):
        if operation == 22 and operands[1] == 64:  # OpTypeFloat
            found.append("double precision: OpTypeFloat 64")
        if operation == 71 and operands[1] == 41 and operands[-1] == 1:  # OpDecorate, LinkageAttributes, Import
            name = text_of(operands[2:-1])
            found += [] if name.startswith("__spirv_BuiltIn") else [f"unresolved: {name}"]
    return found


def clspv_limits(code):
    """Returns texts on what the module uses and clspv does not support."""
    found, types, result_types, calls, names, function = [], {}, {}, {}, {}, None
    for operation, operands in instructions(code):
        if operation == 5:  # OpName
            names[operands[0]] = text_of(operands[1:])
        elif operation == 17 and operands[0] not in CAPABILITIES:  # OpCapability
            found.append(f"capability {operands[0]}")
        elif operation == 71 and operands[1] == 10:  # OpDecorate, CPacked
            found.append(f"packed struct {names.get(operands[0], '')}")
        elif 19 <= operation <= 39:  # OpType...
            types[operands[0]] = operation, operands[1:]
        elif operation == 54:  # OpFunction
            function = operands[1]
        elif operation == 57:  # OpFunctionCall
            calls.setdefault(function, set()).add(operands[2])
        elif operation == 12 and operands[3] not in FUNCTIONS:  # OpExtInst
            found.append(f"function {operands[3]} of OpenCL.std")
        elif operation == 59 and operands[2] == CROSS_WORKGROUP:  # OpVariable
            found.append(f"program-scope variable {names.get(operands[1], '')}")
        elif operation == 120 or operation == 117 and types[result_types[operands[2]]][1][0] not in (FUNCTION, WORKGROUP):
            found.append("conversion between pointer and integer")  # OpConvertUToPtr, OpConvertPtrToU
        if len(operands) > 1 and operands[0] in types:
            result_types[operands[1]] = operands[0]
    found += ["pointer to a pointer" for operation, operands in types.values()
              if operation == 32 and operands[0] != FUNCTION and contains_pointer(operands[1], types)]
    found += [f"recursion in {names.get(caller, caller)}" for caller in calls if caller in reached(caller, calls)]
    return sorted(set(found))


def contains_pointer(kind, types):
    operation, operands = types[kind]
    if operation == 32:  # OpTypePointer
        return True
    members = operands if operation == 30 else operands[:1] if operation == 28 else ()  # OpTypeStruct, OpTypeArray
    return any(contains_pointer(member, types) for member in members)


def reached(caller, calls):
    """Returns the functions that `caller` calls, directly or through others."""
    found, waiting = set(), [caller]
    while waiting:
        new = calls.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found


if __name__ == "__main__":
    all_texts = [f"{file}: {text}" for file in sys.argv[1:] for text in clspv_limits(Path(file).read_bytes())]
    print("\n".join(all_texts), end="\n" if all_texts else "")
    sys.exit(bool(all_texts))
