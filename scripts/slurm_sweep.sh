#!/usr/bin/env bash
# Run a large sweep on a cluster with Slurm: the tasks of a job array compute the parts, and a further job
# merges them when all have ended.
#
# usage: scripts/slurm_sweep.sh INPUT.nml PARTS [--set GROUP.KEY=VALUE ...] [SBATCH OPTION ...]
#        scripts/slurm_sweep.sh INPUT.nml mpi [--set GROUP.KEY=VALUE ...] [SBATCH OPTION ...]
#
#     scripts/slurm_sweep.sh input/million_spins.nml 8 --cpus-per-task=16 --time=04:00:00
#     scripts/slurm_sweep.sh input/million_spins.nml mpi --ntasks=8 --cpus-per-task=16 --time=04:00:00
#
# With `mpi` instead of a number of parts, one job computes the whole sweep under srun. Its ranks request cases
# when they have finished others, which suits cases of unequal cost.
#
# Results are written to OUTPUT (default: output). The program is SPINTOP_EXE (default: build/release/spintop,
# or build/mpi/spintop, which scripts/setup --mpi builds). A minute before its time is over a task is warned
# (--signal): the program keeps what is computed and ends, and the task requeues itself. A task that was stopped,
# requeued or killed resumes its part. To resume after all jobs have ended, call this script again with the same
# arguments: complete parts are not computed again. The nodes should have processors of one kind, because the
# last bits of the numbers may differ between kinds.
set -euo pipefail

# check_values: refuse what is no number of parts. The merge finds the names of tables in what --check prints, a line each.
check_values() {
    local word
    if ! [[ $parts =~ ^(mpi|[1-9][0-9]*)$ ]]; then
        printf 'slurm_sweep.sh: PARTS is a number of parts or mpi, not %q\n' "$parts" >&2
        exit 2
    fi
    for word in "$input" "$output"; do
        if [[ $word = *[[:cntrl:]]* || $word = *' -> '* || $word = *', its '* ]]; then
            printf 'slurm_sweep.sh: a file or folder cannot have the name %q here\n' "$word" >&2
            exit 2
        fi
    done
}

# Slurm runs a copy of this file from another folder, possibly without the environment of the user. A job
# therefore gets its task and all that it needs as arguments.
#
#     slurm_sweep.sh --task compute|mpi|merge PROGRAM OUTPUT INPUT.nml PARTS [--set=GROUP.KEY=VALUE ...]
if [ "${1:-}" = --task ]; then
    if [ $# -lt 6 ]; then
        echo "slurm_sweep.sh: --task is for the jobs that this script submits" >&2
        exit 2
    fi
    task=$2 program=$3 output=$4 input=$5 parts=$6
    study=("${@:7}" --output "$output" -- "$input")
    check_values

    # run COMMAND ...: run it to its end, or until the warning, which ends it with what it has kept; then
    # this task is queued again.
    run() {
        local pid='' code=0 is_warned=''
        trap 'is_warned=1; [ -z "$pid" ] || kill -TERM "$pid" || true' USR1
        trap '[ -z "$pid" ] || kill -TERM "$pid" || true' TERM
        "$@" &
        pid=$!
        wait "$pid" || code=$?
        # A trap interrupts a wait: once more, for the exit code of the command itself.
        if [ "$code" -gt 128 ]; then
            code=0
            wait "$pid" || code=$?
        fi
        if [ -n "$is_warned" ] && [ "$code" -gt 128 ]; then
            echo "slurm_sweep.sh: out of time; queued again"
            local job=$SLURM_JOB_ID
            if [ -n "${SLURM_ARRAY_JOB_ID:-}" ]; then job=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID; fi
            scontrol requeue "$job"
            exit 0
        fi
        exit "$code"
    }
    case $task in
    compute)
        # A part of its own for each task.
        run "$program" --resume --progress --threads "${SLURM_CPUS_PER_TASK:-1}" \
            --shard "$SLURM_ARRAY_TASK_ID/$parts" "${study[@]}"
        ;;
    mpi)
        run srun --cpus-per-task="${SLURM_CPUS_PER_TASK:-1}" "$program" --resume --progress \
            --threads "${SLURM_CPUS_PER_TASK:-1}" "${study[@]}"
        ;;
    merge)
        # table_of OPTION ...: the table that the input names, of rows or, without them, of statistics.
        table_of() {
            local line
            line=$("$program" --check "$@" "${study[@]}" | sed -n '/^! .* -> /p')
            line=${line%%$'\n'*}
            line=${line#*" -> "}
            printf '%s\n' "${line%%", its "*}"
        }
        first=$(table_of --shard "1/$parts")
        tables=() logs=()
        for ((part = 1; part <= parts; ++part)); do
            tables+=("${first/".1-of-$parts."/".$part-of-$parts."}")
            logs+=("${first%%".1-of-$parts."*}.$part-of-$parts.log")
        done
        # The check of the first part has printed the warnings.
        "$program" merge "$(table_of 2>/dev/null)" "${tables[@]}" || exit
        awk '$1 == "time" { longest = $2 > longest ? $2 : longest }
            $1 == "parts" { for (i = 3; i < NF; ++i) if ($i ~ /^(cases|computing|formatting|writing)$/) total += $(i + 1) }
            END { printf "slurm_sweep.sh: the last runs of the parts took %.4g s of processors,", total
                  printf " the longest %.4g s\n", longest }' \
            "${logs[@]}"
        exit
        ;;
    esac
    echo "slurm_sweep.sh: there is no task '$task'" >&2
    exit 2
fi

if [ $# -lt 2 ]; then
    sed -n '2,/^$/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." >/dev/null && pwd -P)
input=$1 parts=$2 output=${OUTPUT:-output}
shift 2
settings=() options=()
while [ $# -gt 0 ]; do
    case $1 in
    --set) settings+=("--set=${2-}") && shift ;;
    --set=*) settings+=("$1") ;;
    *) options+=("$1") ;;
    esac
    shift || true # no value after --set: the program refuses it
done
check_values
build=release
if [ "$parts" = mpi ]; then build=mpi; fi
program=${SPINTOP_EXE:-$root/build/$build/spintop}
[[ $program = [[:alnum:]./_]* ]] || program=./$program # no option of srun
if ! command -v "$program" >/dev/null; then
    printf 'slurm_sweep.sh: there is no program %q\n' "$program" >&2
    exit 2
fi
if ! command -v sbatch >/dev/null; then
    echo "slurm_sweep.sh: there is no sbatch: this is no machine with Slurm. Elsewhere each part is a run of
spintop with --shard PART/PARTS, and \`spintop merge\` joins them" >&2
    exit 2
fi
name=${input##*/}

# The batch shell gets the warning, a minute before the end, and may be queued again.
warned=(--requeue --open-mode=append --signal=B:USR1@60)

# submit TASK [SBATCH OPTION ...]: submit this script again, with a task.
submit() {
    sbatch --parsable "${@:2}" "${BASH_SOURCE[0]}" --task "$1" "$program" "$output" "$input" "$parts" "${settings[@]}"
}

if [ "$parts" = mpi ]; then
    "$program" --check "${settings[@]}" -- "$input" >/dev/null
    submit mpi --job-name="spintop $name" "${warned[@]}" "${options[@]}"
    exit
fi
"$program" --check --shard "1/$parts" "${settings[@]}" -- "$input" >/dev/null
array=$(submit compute --job-name="spintop $name" --array="1-$parts" "${warned[@]}" "${options[@]}")
# Not afterok: a task with failed cases ends with exit code 3. A missing part stops the merge.
submit merge --job-name="spintop merge $name" --dependency="afterany:${array%%;*}" "${options[@]}" --cpus-per-task=1
