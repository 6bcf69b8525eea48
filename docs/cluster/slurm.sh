#!/bin/bash
# A sweep as a Slurm job array, one shard for each task. Change the array's size, SHARDS with it, and the sweep, then
#
#     array=$(sbatch --parsable slurm.sh)
#     sbatch --dependency=afterok:$array --wrap 'tumble merge sweep.csv shard-*.csv'
#
# A task that was pre-empted and is queued again goes on where it ended; so does one that failed, with "sbatch --array=3 slurm.sh".
#SBATCH --job-name=tumble-sweep
#SBATCH --array=1-16
#SBATCH --cpus-per-task=8
#SBATCH --mem-per-cpu=256M
#SBATCH --time=01:00:00
#SBATCH --requeue
set -euo pipefail

# As many as the array has; not SLURM_ARRAY_TASK_COUNT, which is 1 where a single task is submitted again.
SHARDS=16

srun --cpus-per-task="$SLURM_CPUS_PER_TASK" tumble sweep t-handle --worlds 100000 --seed 7 \
    --vary bodies.0.angular_velocity.1=0..5 \
    --vary 'gravity.1=normal(-9.81,0.01)' \
    --threads "$SLURM_CPUS_PER_TASK" --quiet \
    --shard "$SLURM_ARRAY_TASK_ID/$SHARDS" --out "shard-$SLURM_ARRAY_TASK_ID.csv"
