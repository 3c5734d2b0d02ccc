#!/usr/bin/env bash
# Twelve subjects through docs/batch/Snakefile: batch_test.sh PROGRAMS, the folder of the built programs.
# Checks the results, a run after a kill, changes of one subject, and subjects that fail.
set -euo pipefail

# shellcheck source=tests/batch/batch_steps.sh
source "$(dirname "$0")/batch_steps.sh"
need snakemake oiiotool python3
need_colin27

make_folder
cd "$folder"
subjects() { /usr/bin/python3 "$here/make_subjects.py" "$@"; }
volumes() { tail -n +2 "$1/volumes.csv" | LC_ALL=C sort; }
results() { (cd "$1" && find . -not -path './.snakemake/*' -not -path './logs/*' -type f | sort | xargs sha256sum); }
times() { (cd "$1" && stat -c '%n %y' ./*.atlas pictures/*); }
# changed TIMES LIBRARY: atlases and pictures with other times than then.
changed() { times "$2" | diff "$1" - | grep '^>' | cut -d' ' -f2 | xargs; }

# ml_of LIBRARY SUBJECT SIDE: ml of the subject's structures on one side, L or R.
ml_of() {
  awk -F, -v subject="$2" -v side="_$3\$" '$1 == subject && $2 ~ side { sum += $4 } END { print sum + 0 }' \
    "$1/volumes.csv"
}
# mostly LIBRARY SUBJECT SIDE OTHER: whether the subject has far more of one side.
mostly() {
  awk -v much="$(ml_of "$1" "$2" "$3")" -v little="$(ml_of "$1" "$2" "$4")" 'BEGIN { exit !(much > 10 * little) }'
}

subjects make subjects 12
subjects count subjects >expected

say "one run"
run subjects a -j 2 || fail "the run failed"
[[ $(head -n 1 a/volumes.csv) == subject,structure,voxels,ml ]] || fail "volumes.csv has another header"
diff expected <(volumes a) >&2 || fail "volumes.csv differs from counts of the source files"
mostly a s01 L R || fail "s01 is not mostly the left side"
mostly a s02 R L || fail "s02, which is mirrored, is not mostly the right side"
[[ $(file_count a/ '*.atlas') == 12 && $(file_count a/pictures '*.png') == 12 ]] || fail "a result is missing"
for atlas in a/*.atlas; do
  "$programs/splatlas-player" verify "$atlas" >/dev/null || fail "$atlas is not valid"
done

say "a second run has nothing to do"
times a >before
run subjects a -j 2 || fail "the second run failed"
grep -q "Nothing to be done" "$log" || fail "the second run did something"

say "kill after the third atlas"
start subjects b -j 2
until [[ $(file_count b/ '*.atlas') -ge 3 ]]; do
  kill -0 "$batch" || fail "the run ended before the kill"
  sleep 0.02
done
kill -KILL "$batch"
wait "$batch" 2>/dev/null && fail "the killed run ended well"
[[ $(file_count b/ '*.atlas') -lt 12 && ! -e b/volumes.csv ]] || fail "the kill came too late"
resumed=$(file_count b/ '*.atlas')
run subjects b -j 2 --rerun-incomplete || fail "the run after the kill failed"
say "resumed from $resumed atlases"
diff <(results a) <(results b) >&2 || fail "the results after a kill differ from those without"

say "one subject changes sides"
subjects mirror subjects s03
subjects count subjects >expected
times b >before
run subjects b -j 2 || fail "the run after a change failed"
[[ $(changed before b) == "./s03.atlas pictures/s03.png" ]] || fail "not only s03 was made again: $(changed before b)"
diff expected <(volumes b) >&2 || fail "volumes.csv differs after the change"
mostly a s03 L R || fail "s03 was not mostly the left side"
mostly b s03 R L || fail "s03 is not mostly the right side"

say "subjects that fail"
mkdir some
cp -r subjects/s01 "some/a subject with 'quotes'"
cp -r subjects/s02 subjects/s08 subjects/s09 some
head -c 1000 subjects/s08/labels.nii.gz >some/s08/labels.nii.gz
cp subjects/s09/labels.nii.gz some/s09/labels.nii
mkdir some/s10
run some c -j 2 --keep-going && fail "a run with failures ended well"
[[ -e "c/a subject with 'quotes'.atlas" && -e c/s02.atlas ]] || fail "a failure stopped other subjects"
[[ $(file_count c/ '*.atlas') == 2 && ! -e c/volumes.csv ]] || fail "a failed run left results"
grep -q "^s08: build failed: splatlas-preprocess: .*s08/labels.nii.gz: ." "$log" || fail "the message of s08 is missing"
grep -q "^s09: build failed: .*several labels: labels.nii, labels.nii.gz; keep one" "$log" ||
  fail "the message of s09 is missing"
grep -q "^s10: build failed: .*no labels and no volume" "$log" || fail "the message of s10 is missing"

say "the failed subjects are taken out, and an older file takes the place of another"
cp subjects/s05/labels.nii.gz some/s02/labels.nii.gz
touch -d "2001-01-01" some/s02/labels.nii.gz
times c >before
rm -r some/s08 some/s09 some/s10
run some c -j 2 || fail "the run without the failed subjects failed"
[[ $(changed before c) == "./s02.atlas pictures/s02.png" ]] || fail "not only s02 was made again: $(changed before c)"
cmp "c/a subject with 'quotes'.atlas" a/s01.atlas || fail "the name of a subject changes its atlas"
[[ $(cut -d, -f1 c/volumes.csv | sort -u | wc -l) == 3 ]] || fail "volumes.csv lacks a subject"

say "passed"
