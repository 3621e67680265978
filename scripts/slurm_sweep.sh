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

# The environment's values win: Slurm runs a copy of this file from a folder of its own.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
build=release
if [ "${2:-}" = mpi ]; then build=mpi; fi
export SPINTOP_EXE=${SPINTOP_EXE:-$root/build/$build/spintop}
export OUTPUT=${OUTPUT:-output}

case ${SPINTOP_TASK:-submit} in
submit)
    if [ $# -lt 2 ]; then
        sed -n '2,/^$/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
        exit 2
    fi
    input=$1 parts=$2
    shift 2
    if [ "$parts" = mpi ]; then
        "$SPINTOP_EXE" --check "$input" >/dev/null
        export SPINTOP_TASK=mpi
        exec sbatch --parsable --job-name="spintop ${input##*/}" --requeue --open-mode=append \
            "$@" "${BASH_SOURCE[0]}" "$input" mpi
    fi
    "$SPINTOP_EXE" --check --shard "1/$parts" "$input" >/dev/null
    export SPINTOP_TASK=compute
    array=$(sbatch --parsable --job-name="spintop ${input##*/}" --array="1-$parts" --requeue --open-mode=append \
        "$@" "${BASH_SOURCE[0]}" "$input" "$parts")
    export SPINTOP_TASK=merge
    # Not afterok: a task with failed cases ends with exit code 3. A missing part stops the merge.
    sbatch --parsable --job-name="spintop merge ${input##*/}" --dependency="afterany:${array%%;*}" \
        "$@" --cpus-per-task=1 "${BASH_SOURCE[0]}" "$input" "$parts"
    ;;
compute)
    # A part of its own for each task.
    exec "$SPINTOP_EXE" --resume --progress --threads "${SLURM_CPUS_PER_TASK:-1}" \
        --shard "$SLURM_ARRAY_TASK_ID/$2" --output "$OUTPUT" "$1"
    ;;
mpi)
    exec srun --cpus-per-task="${SLURM_CPUS_PER_TASK:-1}" "$SPINTOP_EXE" --resume --progress \
        --threads "${SLURM_CPUS_PER_TASK:-1}" --output "$OUTPUT" "$1"
    ;;
merge)
    # The name of the table is that of the input, or that which the input gives.
    first=$("$SPINTOP_EXE" --check --shard "1/$2" --output "$OUTPUT" "$1" | sed -n '1s/.* -> //p')
    stem=${first%".1-of-$2.csv"}
    tables=()
    for ((part = 1; part <= $2; ++part)); do tables+=("$stem.$part-of-$2.csv"); done
    exec "$SPINTOP_EXE" merge "$stem.csv" "${tables[@]}"
    ;;
esac
