#!/usr/bin/env bash
# What a graphics adapter takes for exact fields and layered depth images, beside the main processor: one table, in under four minutes.
#
#     tools/gpu_bench.sh PROGRAM [MESH...]
#
# PROGRAM is a built meshwright with the graphics backend; gpu_times, from `cargo build --release --example gpu_times`, is looked for in the folder
# examples beside it, or where GPU_TIMES says. Without a MESH those of testdata are taken. Meshes are repaired first: fields by pseudonormals need closed
# ones. A real adapter does the sizes that docs/benchmarks.md speaks of, a software one small ones; GPU_BENCH=small|full decides otherwise.
#
# Rows `field` and `LDIs` are times within one process, the best of three, the device open: the main processor alone, all that the adapter's way takes,
# and of it the adapter's passes by its own clock, in ms; then MB sent up and down. Rows `file` are whole processes, from the start to the written and
# verified file, opening the device and compiling its programs included.
set -euo pipefail

if [ "$#" -lt 1 ] || [ ! -x "$1" ]; then
    echo "usage: tools/gpu_bench.sh PROGRAM [MESH...]" >&2
    exit 2
fi
program=$1
shift
times=${GPU_TIMES:-$(dirname "$program")/examples/gpu_times}
if [ ! -x "$times" ]; then
    echo "$times is not there: cargo build --release --example gpu_times, or GPU_TIMES=PATH" >&2
    exit 2
fi
root=$(cd "$(dirname "$0")/.." && pwd)
if [ "$#" -eq 0 ]; then
    set -- "$root/testdata/torus.ply" "$root/testdata/monkey_saddle.off"
fi
# Mesa otherwise looks for a desktop, and says that there is none.
export NODEVICE_SELECT=1

devices=$("$program" devices --json)
if ! grep -q '"gpu": *"' <<<"$devices"; then
    echo "no graphics adapter; \`$program devices\` says what to install" >&2
    exit 1
fi
size=${GPU_BENCH:-}
if [ -z "$size" ]; then
    # What --backend auto would take is real hardware.
    if grep -q '"auto": *"' <<<"$devices"; then size=full; else size=small; fi
fi
case $size in
full) fields=(256 512) ldis=(256 1024) files=(256 512) ;;
small) fields=(32 64) ldis=(64 128) files=(64) ;;
*)
    echo "GPU_BENCH is full or small" >&2
    exit 2
    ;;
esac

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
rows=$folder/rows
end=$((SECONDS + 210))

# Prints the milliseconds that a command takes, and what it says only if it fails.
milliseconds() {
    local start
    start=$(date +%s%N)
    "$@" >"$folder/said" 2>&1 || { cat "$folder/said" >&2; return 1; }
    echo $((($(date +%s%N) - start) / 1000000))
}

whole_files() {
    local mesh=$1 at=$2 band cpu gpu
    band=$((at / 10))h
    cpu=$(milliseconds "$program" sdf "$mesh" -o "$folder/cpu.vdb" --resolution "$at" --band "$band" --backend cpu --force)
    gpu=$(milliseconds "$program" sdf "$mesh" -o "$folder/gpu.vdb" --resolution "$at" --band "$band" --backend gpu --force)
    printf '%s\tfile\t%s\t%s\t%s\t\t\t\tsdf --band %s, a .vdb\n' "$(basename "$mesh" .ply)" "$at" "$cpu" "$gpu" "$band" >>"$rows"
}

printf 'mesh\twhat\tat\tmain processor\tall\tpasses\tup\tdown\tnote\n' >"$rows"
for mesh in "$@"; do
    name=$(basename "$mesh")
    closed=$folder/${name%.*}.ply
    "$program" repair "$mesh" -o "$closed" --resolution 256 --backend cpu >"$folder/said" 2>&1 || { cat "$folder/said" >&2; exit 1; }
    for at in "${fields[@]}"; do
        [ "$SECONDS" -ge "$end" ] || "$times" "$closed" --rows --field "$at" >>"$rows"
    done
    for at in "${ldis[@]}"; do
        [ "$SECONDS" -ge "$end" ] || "$times" "$closed" --rows --ldi "$at" >>"$rows"
    done
    for at in "${files[@]}"; do
        [ "$SECONDS" -ge "$end" ] || whole_files "$closed" "$at"
    done
done
"$program" devices 2>&1 | head -3
if command -v column >/dev/null; then column -t -s "$(printf '\t')" "$rows"; else cat "$rows"; fi
if [ "$SECONDS" -ge "$end" ]; then
    echo "some rows are left out: their time was up" >&2
fi
