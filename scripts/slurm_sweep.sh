#!/usr/bin/env bash
# A large sweep on a cluster that runs Slurm: parts of it by the tasks of a job array, and a job that
# joins them when all have ended.
#
# usage: scripts/slurm_sweep.sh INPUT.nml PARTS [SBATCH OPTION ...]
#        scripts/slurm_sweep.sh INPUT.nml mpi [SBATCH OPTION ...]
#
#     scripts/slurm_sweep.sh input/million_spins.nml 8 --cpus-per-task=16 --time=04:00:00
#     scripts/slurm_sweep.sh input/million_spins.nml mpi --ntasks=8 --cpus-per-task=16 --time=04:00:00
#
# With `mpi` in place of a number of parts, one job computes the whole, under srun: its ranks share
# the cases out as they go, which suits cases that take unequal time.
#
# Results go to OUTPUT (default: output), the program is SPINTOP_EXE (default: build/release/spintop, or
# build/mpi/spintop, which scripts/setup --mpi builds). A task that is stopped, requeued or killed goes
# on where it was; to go on after all has ended, call this again with the same arguments: what is
# complete is not computed again. The nodes should be of one kind: on processors of different kinds
# the last bits of the numbers may differ.
set -euo pipefail

# Slurm runs a copy of this file from a folder of its own, and may give it no environment but its own:
# a job has its task and all that it needs as arguments.
#
#     slurm_sweep.sh --task compute|mpi|merge PROGRAM OUTPUT INPUT.nml PARTS
if [ "${1:-}" = --task ]; then
    if [ $# != 6 ]; then
        echo "slurm_sweep.sh: --task is for the jobs that this script submits" >&2
        exit 2
    fi
    task=$2 program=$3 output=$4 input=$5 parts=$6
    case $task in
    compute)
        # A part of its own for each task.
        exec "$program" --resume --progress --threads "${SLURM_CPUS_PER_TASK:-1}" \
            --shard "$SLURM_ARRAY_TASK_ID/$parts" --output "$output" "$input"
        ;;
    mpi)
        exec srun --cpus-per-task="${SLURM_CPUS_PER_TASK:-1}" "$program" --resume --progress \
            --threads "${SLURM_CPUS_PER_TASK:-1}" --output "$output" "$input"
        ;;
    merge)
        # The name of the table is that of the input, or that which the input gives.
        first=$("$program" --check --shard "1/$parts" --output "$output" "$input" | sed -n '1s/.* -> //p')
        stem=${first%".1-of-$parts.csv"}
        tables=()
        for ((part = 1; part <= parts; ++part)); do tables+=("$stem.$part-of-$parts.csv"); done
        exec "$program" merge "$stem.csv" "${tables[@]}"
        ;;
    esac
    echo "slurm_sweep.sh: there is no task '$task'" >&2
    exit 2
fi

if [ $# -lt 2 ]; then
    sed -n '2,/^$/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
input=$1 parts=$2
shift 2
build=release
if [ "$parts" = mpi ]; then build=mpi; fi
program=${SPINTOP_EXE:-$root/build/$build/spintop}
output=${OUTPUT:-output}
name=${input##*/}

# submit TASK [SBATCH OPTION ...]: submit this script again, with a task.
submit() {
    sbatch --parsable "${@:2}" "${BASH_SOURCE[0]}" --task "$1" "$program" "$output" "$input" "$parts"
}

if [ "$parts" = mpi ]; then
    "$program" --check "$input" >/dev/null
    submit mpi --job-name="spintop $name" --requeue --open-mode=append "$@"
    exit
fi
"$program" --check --shard "1/$parts" "$input" >/dev/null
array=$(submit compute --job-name="spintop $name" --array="1-$parts" --requeue --open-mode=append "$@")
# Not afterok: a task with failed cases ends with exit code 3. A missing part stops the merge.
submit merge --job-name="spintop merge $name" --dependency="afterany:${array%%;*}" "$@" --cpus-per-task=1
