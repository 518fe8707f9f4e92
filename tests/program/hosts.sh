#!/usr/bin/env bash
# A sweep on three hosts: network namespaces with their own host names, joined by a bridge. Its maps must be bitwise
# those of a single rank, and the messages must have crossed the network.
#
#   tests/program/hosts.sh PROGRAM      needs root, iproute2, Open MPI and python3-h5py; exits with 77 if it cannot run
set -euo pipefail

program=$(realpath "$1")
python=$([[ -x /usr/bin/python3 ]] && echo /usr/bin/python3 || echo python3)
skip() { echo "skipped: $*"; exit 77; }
[[ $(id -u) -eq 0 ]] || skip "only root can create network namespaces"
command -v ip >/dev/null || skip "iproute2 is missing"
mpirun --version | grep -q "Open MPI" || skip "the launch agent is written for Open MPI"

directory=$(mktemp -d)
net=tb$$ # short: the name of an interface has at most 15 characters
hosts=()
clean_up() {
  for host in "${hosts[@]}"; do
    ip netns pids "$host" | xargs -r kill -9 2>/dev/null || true # a process may just have ended
    ip netns delete "$host"
  done
  ip link delete "$net" 2>/dev/null || true
  rm -rf "$directory"
}
trap clean_up EXIT

ip link add "$net" type bridge 2>/dev/null || skip "cannot create a network bridge here"
ip link set "$net" up
for i in 1 2 3; do
  host=$net-$i
  ip netns add "$host" || skip "cannot create network namespaces here"
  hosts+=("$host")
  ip link add "$net.$i" type veth peer name eth0 netns "$host"
  ip link set "$net.$i" master "$net" up
  ip -n "$host" address add "10.213.97.$i/24" dev eth0
  ip -n "$host" link set eth0 up
  ip -n "$host" link set lo up
  echo "$host slots=2" >>"$directory/hosts"
done

# mpirun calls this instead of ssh: agent HOST COMMAND...
cat >"$directory/agent" <<'AGENT'
#!/usr/bin/env bash
host=$1
shift
exec ip netns exec "$host" unshare --uts bash -c 'hostname "$1"; eval "exec $2"' on "$host" "$*"
AGENT
chmod +x "$directory/agent"

export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_ess_singleton_isolated=1
export HWLOC_HIDE_ERRORS=2
on_hosts() { # COUNT MPIRUN-ARGUMENTS...: runs on the first COUNT hosts
  # rsh: also inside a batch job. yield: the hosts share the cores without knowing it.
  local mca=(plm rsh plm_rsh_agent "$directory/agent" btl "self,vader,tcp" btl_tcp_if_include eth0
             oob_tcp_if_include eth0 mpi_yield_when_idle 1)
  head -n "$1" "$directory/hosts" >"$directory/hostfile"
  timeout 120 "$directory/agent" "${hosts[0]}" mpirun --hostfile "$directory/hostfile" \
    "$(printf -- '--mca %s %s ' "${mca[@]}")" "${@:2}"
}
sweep() { # COUNT RANKS ARCHIVE
  on_hosts "$1" --map-by node -n "$2" "$program" sweep "$job" --output.file "$3" --progress none
}
sent() { ip netns exec "$1" cat /sys/class/net/eth0/statistics/tx_bytes; }
same_maps() {
  $python - "$@" <<'PYTHON'
import sys
import h5py
with h5py.File(sys.argv[1]) as one, h5py.File(sys.argv[2]) as other:
    for name in ("speed", "release_time", "status"):
        assert one[name][...].tobytes() == other[name][...].tobytes(), name
PYTHON
}

[[ $(on_hosts 3 --map-by node -n 3 hostname | sort) == "$(printf '%s\n' "${hosts[@]}")" ]]
echo "ok: a rank on each of ${hosts[*]}"

job=$directory/job.cfg
printf '[lattice]\nincrement = 0.005\n[solver]\nstepper = dopri5\ntolerance = 1e-9\n' >"$job"
"$program" sweep "$job" --output.file "$directory/alone.h5" --progress none >"$directory/log"
before=$(sent "${hosts[2]}")
sweep 3 6 "$directory/three.h5"
bytes=$(($(sent "${hosts[2]}") - before))
same_maps "$directory/alone.h5" "$directory/three.h5"
[[ $bytes -gt 20000 ]] || { echo "only $bytes bytes came from the third host"; exit 1; }
echo "ok: six ranks on three hosts produce the maps of a single rank ($bytes bytes came from the third)"

sweep 3 6 "$directory/lost.h5" >"$directory/log" 2>&1 &
running=$!
# Kill the host during the sweep on a machine of any speed: once the first tiles are marked done.
until "$program" info "$directory/lost.h5.partial" 2>/dev/null | grep -q '^tiles *[1-9]'; do
  kill -0 $running || { cat "$directory/log"; echo "the sweep ended before its host was killed"; exit 1; }
  sleep 0.05
done
ip netns pids "${hosts[2]}" | xargs kill -9
code=0
wait $running || code=$?
cat "$directory/log"
[[ $code -ne 0 && $code -ne 124 && ! -e $directory/lost.h5 ]]
echo "ok: without its third host the sweep ends, with exit code $code"
sweep 2 4 "$directory/lost.h5"
same_maps "$directory/alone.h5" "$directory/lost.h5"
echo "ok: the other two continue it and produce the same maps"
