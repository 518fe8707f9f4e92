#!/usr/bin/env bash
# Fuzzes job files and archives with Clang's libFuzzer. Inputs that fail are kept in build/fuzz/found.
#
#   tests/fuzz/fuzz.sh [SECONDS]      for each of the two, default 300
#
# Needs clang++ with libFuzzer (Debian: clang) and a build (jobs/build.sh).
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-300}

cmake --preset fuzz
cmake --build --preset fuzz
mkdir -p build/fuzz/found build/fuzz/seeds/{job,archive}
cp jobs/*.cfg build/fuzz/seeds/job
for scene in jobs/scenes/*.cfg; do cp "$scene" "build/fuzz/seeds/job/scene_${scene##*/}"; done
# The refused jobs of the tests: options follow the text of a job file, after a zero byte.
python3 - tests/job/refused.json build/fuzz/seeds/job <<'EOF'
import json, sys
with open(sys.argv[1], encoding="utf-8") as file:
    refused = json.load(file)
jobs = [*refused["files"], *("\0" + "\n".join(f"{key}={text}" for key, text in keys.items()) for keys in refused["together"]),
        *(f"\0{key}={text}" for keys, texts in refused["values"] for key in keys for text in texts)]
for n, job in enumerate(jobs):
    with open(f"{sys.argv[2]}/refused_{n}", "w", encoding="utf-8") as seed:
        seed.write(job)
EOF
# Small complete archives of every kind: snapshots differ from them only in tile_designs.
for option in "output.compression 0" "output.compression 4" "output.storage float32" "output.fields speed,status,slack" \
  "scene.projectile-mass 50:100:50" "output.maps none"; do
  OMPI_MCA_ess_singleton_isolated=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
    build/release/trebsweep sweep jobs/accurate.cfg --lattice.r1 0.6:0.9:0.1 --lattice.r3 0.5:0.9:0.2 \
    --lattice.r2 0.5:0.9:0.2 "--${option% *}" "${option#* }" --overwrite --progress none \
    --output.file "build/fuzz/seeds/archive/${option// /_}.h5" >build/fuzz/log
done

export ASAN_OPTIONS=detect_leaks=0
fuzz() { # NAME MAX_LENGTH OPTIONS...
  mkdir -p "build/fuzz/corpus/$1"
  build/fuzz/tests/fuzz_"$1" -max_len="$2" -max_total_time="$seconds" -artifact_prefix=build/fuzz/found/"$1"- \
    -print_final_stats=1 "${@:3}" "build/fuzz/corpus/$1" "build/fuzz/seeds/$1"
}
fuzz job 4096 -timeout=10
# HDF5 is not instrumented for coverage, so every seed is kept.
fuzz archive 60000 -timeout=100 -keep_seed=1 -reduce_inputs=0 -len_control=0
