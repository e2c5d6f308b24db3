#!/usr/bin/env bash
# Repairs a folder of meshes on several machines by GNU parallel, which sends one share to each.
#
#     examples/cluster/parallel.sh IN OUT SHARES [options of parallel, such as --sshloginfile FILE]
#
# IN and OUT are seen by all machines under the same names. Without a list of machines all shares are done on this one.
set -euo pipefail
if [ $# -lt 3 ]; then
    echo "usage: $0 IN OUT SHARES [options of parallel]" >&2
    exit 2
fi
in=$1 out=$2 shares=$3
shift 3
program=${MESHWRIGHT:-meshwright}
seq "$shares" | parallel --jobs 1 "$@" \
    "$program batch repair $(printf %q "$in") --out $(printf %q "$out") --shard {}/$shares --resume --timeout 30m || [ \$? -eq 3 ]"
