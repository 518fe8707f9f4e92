#!/usr/bin/env bash
# Installs missing packages, builds the program, sweeps a job, searches for its optimum and draws both into results/.
# Of a study it draws the optima of the scenes. If a trebsweep of the same version is installed, nothing is built.
#
#   jobs/run.sh [JOB] [-n RANKS] [-- options]      default: jobs/paper.cfg on 2 ranks
#   jobs/run.sh jobs/accurate.cfg -n 4 -- --scene.projectile-mass 50
set -euo pipefail

usage() { sed -n '2,6s/^# \{0,1\}//p' "$0"; }

job='' ranks=2
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    -n) ranks=${2:-}; shift $(($# > 1 ? 2 : 1)) ;;
    --) shift; break ;;
    -*) echo "jobs/run.sh: $1: unknown option; options of trebsweep go after --" >&2; exit 2 ;;
    *)
      [[ -z $job ]] || { echo "jobs/run.sh: $1: only one job can be given" >&2; exit 2; }
      job=$1; shift ;;
  esac
done
[[ $ranks =~ ^[1-9][0-9]*$ ]] || { echo "jobs/run.sh: -n $ranks: must be an integer above 0" >&2; exit 2; }
for option in "$@"; do
  [[ $option != --output.file* ]] ||
    { echo "jobs/run.sh: --output.file: the archive is written to results/; use trebsweep sweep for another path" >&2
      exit 2; }
done
repository=$(cd "$(dirname "$0")/.." && pwd)
job=$(realpath -m -- "${job:-$repository/jobs/paper.cfg}")
program=trebsweep
explorer=$repository/explorer.html

is_installed() { # whether the trebsweep on PATH is that of these sources
  local version revision
  version=$(sed -n 's/^project(trebsweep VERSION \([0-9.]*\) .*/trebsweep \1/p' CMakeLists.txt 2>/dev/null)
  revision=$(git describe --always --dirty --abbrev=12 2>/dev/null) && version+=" ($revision)"
  [[ -n $version && $revision != *-dirty && $(trebsweep --version 2>/dev/null) == "$version"* ]]
}
if [[ -e $repository/jobs/build.sh ]]; then # it is not installed, as all else is
  cd "$repository"
  explorer="analysis/explorer/build.sh --archive"
  is_installed || { jobs/build.sh; program=build/release/trebsweep; }
fi
python=$([[ -x /usr/bin/python3 ]] && echo /usr/bin/python3 || echo python3)
# By default Open MPI refuses to run as root, or with more ranks than cores. Other MPIs ignore these variables.
export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
export HWLOC_HIDE_ERRORS=2 # no warnings if /sys is not mounted
[[ $(id -u) -ne 0 ]] || export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

mkdir -p results
name=$(basename "$job")
name=${name%.*}
archive=results/$name.h5
mpirun -n "$ranks" $program sweep "$job" --output.file "$archive" "$@"
[[ $explorer == *.html ]] || explorer+=" $(printf %q "$archive")"
explorer="A page that explores the design space in a browser: $explorer"

if [[ $($program info "$archive") == *$'\nscenes '* ]]; then # a study: the optima of its scenes
  $python "$repository/analysis/treb-plot" study "$archive" -o "results/$name.png" | tee "results/$name.txt"
  [[ $explorer == *.html ]] || explorer+=" --at KEY=VALUE"
  echo "$explorer"
  exit
fi
$python "$repository/analysis/treb-plot" heatmap "$archive" -o "results/$name.png"
# The optimum between the designs of the lattice, if there is one: what `trebsweep optimum` reports, its swing and its
# neighbourhood. The job is the archive's, with an accurate solver.
design=$($python "$repository/analysis/treb-plot" optimum "$archive" --continuous --job "results/$name-optimum.cfg" --overwrite)
if [[ -n $design ]]; then
  mpirun -n "$ranks" $program optimum "results/$name-optimum.cfg" | tee "results/$name-optimum.txt"
  # shellcheck disable=SC2086  # three options with their values
  $program trace "results/$name-optimum.cfg" $design >"results/$name-swing.txt"
  # shellcheck disable=SC2086
  $program trace "results/$name-optimum.cfg" $design --flight >"results/$name-flight.txt"
  $python "$repository/analysis/treb-plot" trajectory "results/$name-swing.txt" --flight "results/$name-flight.txt" \
    -o "results/$name-swing.png"
  $python "$repository/analysis/treb-plot" neighbourhood "results/$name-optimum.cfg" -o "results/$name-neighbourhood.png"
  $python "$repository/analysis/treb-plot" sheet "results/$name-optimum.cfg" -n "$ranks" -o "results/$name-sheet.pdf"
fi
echo "$explorer"
