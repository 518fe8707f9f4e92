#!/usr/bin/env bash
# Runs sweeps as PBS jobs (OpenPBS, PBS Professional) that continue automatically: shortly before the time limit the
# sweep stops after a tile, and the job resubmits itself until its archive is complete.
#
#   qsub -v jobs=jobs/millimetre.cfg jobs/pbs.sh                       one sweep
#   jobs="a.cfg b.cfg c.cfg" qsub -J 1-3 -v jobs jobs/pbs.sh           three, one per subjob
#   options="--output.compression 1" qsub -v jobs=JOB,options jobs/pbs.sh
#
# Archives are written to the directory in which the job is submitted. Set resources and queue below, because options
# of qsub are lost when the job resubmits itself. A sweep that fails (exit codes 1 and 2) is not resubmitted; fix the
# cause and submit it again to continue the sweep.

#PBS -N trebsweep
#PBS -l select=2:ncpus=32:mpiprocs=32
#PBS -l walltime=01:00:00
#PBS -j oe
#PBS -r y
# No set -eu: it breaks module load and, in old versions of bash, empty arrays.

cd "${PBS_O_WORKDIR:?submit it with: qsub -v jobs=JOB jobs/pbs.sh}" || exit
script=${script:-jobs/pbs.sh}                 # this file and the program: relative to qsub's directory, or absolute
program=trebsweep                             # the one on PATH, unless there is one in build/release
[[ ! -x build/release/trebsweep ]] || program=build/release/trebsweep
program=${TREBSWEEP:-$program}
margin=180                                    # s before the limit to stop at; a tile of the sweep takes a second
most_restarts=100                             # a limit in case something is wrong
launch=(mpirun -machinefile "$PBS_NODEFILE" -n "$(wc -l <"$PBS_NODEFILE")" --bind-to core)
# module load gcc openmpi hdf5                # those that the program was built with
# export HDF5_USE_FILE_LOCKING=FALSE          # if opening a file hangs, or fails for lack of locks

refuse() {
  echo "jobs/pbs.sh: $*" >&2
  exit 2
}

# PBS reruns a job whose node failed; the rerun continues the unfinished sweep.
runs=$(qstat -f "$PBS_JOBID" | sed -n 's/^ *run_count = //p')
[[ ${runs:-1} -le 1 ]] || options=${options//--overwrite/}
read -ra files <<<"${jobs:-}"
read -ra arguments <<<"${options:-}"
restart=${restart:-0}
[[ ${#files[@]} -gt 0 ]] || refuse "no job file given; usage: qsub -v jobs=JOB jobs/pbs.sh"
[[ ${#files[@]} -eq 1 || -n ${PBS_ARRAY_INDEX:-} ]] ||
  refuse "${#files[@]} job files need a job array: qsub -J 1-${#files[@]} ..."
number=${PBS_ARRAY_INDEX:-1}
[[ $number -ge 1 && $number -le ${#files[@]} ]] ||
  refuse "-J: there is no job file number $number, only 1 to ${#files[@]}"
job=${files[number - 1]}
command -v "$program" >/dev/null || refuse "$program: no such program; build or install it, or set TREBSWEEP"

# The time limit, h:m:s; PBS sends no signal before it.
walltime=$(qstat -f "$PBS_JOBID" | sed -n 's/^ *Resource_List.walltime = //p')
if [[ $walltime =~ ^([0-9]+):([0-9]+):([0-9]+)$ ]]; then
  seconds=$((10#${BASH_REMATCH[1]} * 3600 + 10#${BASH_REMATCH[2]} * 60 + 10#${BASH_REMATCH[3]} - margin))
  [[ $seconds -gt 0 ]] || refuse "walltime = $walltime: must be longer than $margin s"
  arguments=(--time-limit "$seconds" "${arguments[@]}")
fi

# TERM is from qdel or the time limit. The launcher forwards USR1 to the ranks, which then finish their tile.
sweep='' cancelled=no
trap 'cancelled=yes; kill -USR1 $sweep' TERM
"${launch[@]}" "$program" sweep "$job" "${arguments[@]}" &
sweep=$!
while kill -0 $sweep 2>/dev/null; do wait $sweep; done # a trap interrupts wait
wait $sweep
code=$?

if [[ $code -eq 75 && $cancelled == no ]]; then
  if [[ $restart -ge $most_restarts ]]; then
    echo "jobs/pbs.sh: not complete after $most_restarts restarts; submit it again to continue" >&2
  else
    echo "jobs/pbs.sh: resubmitting the job" >&2
    options=${options:-}
    export jobs=$job restart=$((restart + 1)) options=${options//--overwrite/} script TREBSWEEP=$program
    qsub -v jobs,options,restart,script,TREBSWEEP "$script" ||
      echo "jobs/pbs.sh: not resubmitted; submit it again to continue" >&2
  fi
fi
exit $code
