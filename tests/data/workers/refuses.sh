#!/bin/sh
# What a worker program of another build does: it sends a refusal over its socket, and ends.
printf 'HEMIREFUthe worker program is of hemi 9.9.9' >&3
exit 1
