"""Loaded first by the process that workers are forked from: it complains to nobody.

Workers that are ended as they begin would print tracebacks after the last word of the
sweep. Elsewhere nothing is muted.
"""

import os
import sys

if "multiprocessing.forkserver" in " ".join(sys.orig_argv):
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
