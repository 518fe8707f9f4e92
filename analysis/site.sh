#!/usr/bin/env bash
# Installs missing Debian packages and builds the manual: the Markdown files as pages with a search, and the explorer.
#
#   analysis/site.sh [-o DIRECTORY]      default: results/site, which is replaced
#
# Open index.html, or serve the directory (python3 -m http.server -d results/site): browsers search only served pages.
set -euo pipefail

usage() { sed -n '2,6s/^# \{0,1\}//p' "$0"; }
site=''
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    -o) [[ -n ${2:-} ]] || { echo "analysis/site.sh: -o: needs the path of a directory" >&2; exit 2; }
        site=$(realpath -m -- "$2"); shift 2 ;;
    *) echo "analysis/site.sh: $1: unknown option" >&2; exit 2 ;;
  esac
done
cd "$(dirname "$0")/.."
[[ -n $site ]] || site=$PWD/results/site
if [[ -e $site && ! -e $site/search/search_index.json ]]; then
  echo "analysis/site.sh: -o $site: exists and is not a site; choose another directory" >&2
  exit 2
fi

jobs/install.sh mkdocs
build=$PWD/build/site
rm -rf "$build"
mkdir -p "$build/pages"
find . \( -path ./build -o -path ./results -o -path './.*' \) -prune -o -type f \
  \( -name '*.md' -o -name '*.ipynb' -o -path './analysis/pictures/*' -o -name '*.cfg' -o -name LICENSE -o -name CITATION.cff \) -print0 |
  xargs -0 cp --parents -t "$build/pages"
analysis/explorer/build.sh -o "$build/pages/explorer.html" --overwrite >/dev/null
cat >"$build/mkdocs.yml" <<END
site_name: trebsweep
docs_dir: pages
site_dir: $site
use_directory_urls: false
theme:
  name: readthedocs
  highlightjs: false
markdown_extensions: [tables, fenced_code]
plugins: [search]
nav:
  - Start: README.md
  - Explorer: explorer.html
  - Use:
      - Jobs, the optimum, clusters: jobs/README.md
      - Fields, archives, pictures: analysis/README.md
  - Results:
      - The paper, built machines: analysis/results/README.md
      - Rules of thumb: analysis/results/rules.md
  - How it works:
      - The equations: include/trebsweep/model/README.md
      - The code: src/README.md
      - Tests, accuracy, steppers: tests/README.md
      - Speed: tests/benchmarks/README.md
      - Changes: CHANGELOG.md
END
mkdocs build --quiet --config-file "$build/mkdocs.yml"
echo "$site/index.html"
