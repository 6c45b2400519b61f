# Run by `make reduce`: writes reduced.cl, the smallest part of kernel.cl that cvise finds in which the first wrong word is
# still wrong on the failing device, and right in Oclgrind, which must report no invalid access and no unset value.
folder=$(cd "$(dirname "$0")" && pwd)
for program in cvise oclgrind; do
    command -v $program >/dev/null || { echo "reduce: $program is missing; remedy: apt-get install $program" >&2; exit 125; }
done
WORD=$($RUN "$folder/repro" "$folder/kernel.cl" | sed -n 's/ is 0x.*//p' | head -n 1)
export WORD RUN
[ -n "$WORD" ] || { echo "reduce: no wrong word; only cases with wrong words can be reduced" >&2; exit 125; }
# clang, if there is one, rejects a variable that is used without a value, before the slower steps. TIMEOUT ends endless loops.
TIMEOUT="timeout 20"
CHECK="clang -x cl -cl-std=CL1.2 -target spir64 -fsyntax-only -Werror=uninitialized -Werror=sometimes-uninitialized"
$CHECK "$folder/kernel.cl" 2>/dev/null || CHECK=:
# Oclgrind 21.10 takes some results of vector operations for unset values. If it does so in the whole kernel, only clang checks.
UNSET=--uninitialized
DEVICE=Oclgrind $TIMEOUT oclgrind $UNSET "$folder/repro" "$folder/kernel.cl" 2>&1 | grep -q uninitialized && UNSET=
cat > "$folder/interesting.sh" <<END
#!/bin/sh
$CHECK reduced.cl >/dev/null 2>&1 || exit 1
$TIMEOUT $RUN "$folder/repro" reduced.cl >/dev/null 2>&1
[ \$? = 1 ] || exit 1
DEVICE=Oclgrind $TIMEOUT oclgrind $UNSET "$folder/repro" reduced.cl >oclgrind.log 2>&1 || exit 1
! grep -q -i -E 'invalid|uninitialized|race|error' oclgrind.log
END
chmod +x "$folder/interesting.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
grep -v '^#line' "$folder/kernel.cl" > "$work/reduced.cl"
# Without preprocessor directives the reduction goes further, if the fault is still there.
if command -v clang >/dev/null && clang -E -P -x cl -cl-std=CL1.2 -target spir64 "$work/reduced.cl" > "$work/expanded.cl" 2>/dev/null; then
    mkdir "$work/try" && cp "$work/expanded.cl" "$work/try/reduced.cl"
    (cd "$work/try" && "$folder/interesting.sh") && cp "$work/expanded.cl" "$work/reduced.cl"
fi
(cd "$work" && cvise "$folder/interesting.sh" reduced.cl) && cp "$work/reduced.cl" "$folder/reduced.cl" && wc -l "$folder/reduced.cl"
