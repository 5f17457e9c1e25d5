# SPDX-License-Identifier: BSD-3-Clause
# What a job does under any scheduler: run, and submit itself again while checkpoints are left behind.
script=@script@
output=@output@
most=@resubmissions@
resubmission=${HARMOS_RESUBMISSION:-@first@}
@modules@
set -u # not before: scripts of module systems look at variables that are not set

# One thread a rank: the ranks take all cores.
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

restart=()
if [ "$resubmission" -gt 0 ]; then
  restart=(--restart "$output")
fi

pid=
signalled=0
status=0
# In the background, so that the shell hears signals; what it hears goes on to the launcher, which tells all
# ranks: write a checkpoint and stop.
trap 'signalled=1; [ -z "$pid" ] || kill -USR1 "$pid"' USR1
@launch@ \
  @program@ "${restart[@]}" </dev/null &
pid=$!
while :; do
  signalled=0
  wait "$pid"
  got=$?
  if [ "$got" -ne 127 ]; then
    status=$got
  fi
  if [ "$signalled" -eq 0 ]; then
    break
  fi
done

# 4: stopped by a signal, with a checkpoint.
if [ "$status" -eq 4 ]; then
  if [ "$((resubmission - @first@))" -lt "$most" ]; then
    if resubmit "$((resubmission + 1))"; then
      echo "Stopped with a checkpoint; submitted again, number $((resubmission + 1))."
    else
      echo "error: stopped with a checkpoint, but the scheduler refused the next job" >&2
    fi
  else
    echo "error: stopped with a checkpoint after $most resubmissions; go on by harmos-submit --restart" >&2
  fi
fi
exit "$status"
