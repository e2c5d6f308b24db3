#!/usr/bin/env bash
# Repairs a folder of meshes as an array of jobs of Slurm.
#
#     sbatch examples/cluster/slurm_array.sh IN OUT [options of repair]
#
# Each element of the array does its share of the files, with a log of its own; sent once more, it does what is left.
#SBATCH --job-name=meshwright
#SBATCH --array=1-16
#SBATCH --cpus-per-task=8
#SBATCH --mem=16G
#SBATCH --time=04:00:00
set -euo pipefail
if [ $# -lt 2 ]; then
    echo "usage: sbatch $0 IN OUT [options of repair]" >&2
    exit 2
fi
in=$1 out=$2
shift 2
# Exit status 3 says that some files have no result: they are in the log, and the share is done.
"${MESHWRIGHT:-meshwright}" batch repair "$in" --out "$out" --shard slurm --resume \
    --threads "${SLURM_CPUS_PER_TASK:-1}" --timeout 30m "$@" || [ $? -eq 3 ]
