#!/bin/sh
# A sweep with GNU parallel, one process for each shard: on this machine, or on those that PARALLEL_OPTIONS names
# ("--sshlogin a,b --workdir . --return shard-{}.csv", say). Run again after a failure, it goes on where it ended.
#
#     sh parallel.sh SHARDS OUT SCENE --worlds N --seed S --vary FIELD=LO..HI ...
set -eu
shards=$1 out=$2
shift 2

for option; do
    case $option in
    --plot | --plot=*)
        echo "parallel.sh: --plot is not for shards; draw the merged file: the sweep's command again, with --out $out --plot FILE" >&2
        exit 2
        ;;
    esac
done

# shellcheck disable=SC2086 # the options are several words
seq "$shards" | parallel --halt soon,fail=1 ${PARALLEL_OPTIONS:-} --quote \
    tumble sweep "$@" --threads 1 --quiet --shard "{}/$shards" --out "shard-{}.csv"

# shellcheck disable=SC2046 # names without spaces
tumble merge "$out" $(seq -f 'shard-%.0f.csv' "$shards")
