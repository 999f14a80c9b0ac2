# SPDX-License-Identifier: Apache-2.0
"""squares.py SQUARES: many short tasks in two lists, long values, and a task that fails in some rank."""
import sys

import ranks

COUNT = 3000
expected = "".join(f"{sum(i * i for i in range(n))}\n" for n in (COUNT // 2, COUNT))
for count in (1, 2, 5):
    status, output = ranks.run(count, sys.argv[1], COUNT, timeout_s=60)
    assert (status, output) == (0, expected), f"{count} ranks: {status}\n{output}"
    status, output = ranks.run(count, sys.argv[1], COUNT, 2000, timeout_s=60)
    lines = output.splitlines()
    assert status == 1 and lines[0] == expected.splitlines()[0], f"{count} ranks: {status}\n{output}"
    assert lines[1].startswith("2000: ") and "no square" in lines[1], output
# No task at all, and fewer tasks than ranks.
assert ranks.run(3, sys.argv[1], 0) == (0, "0\n0\n")
assert ranks.run(3, sys.argv[1], 2) == (0, "0\n1\n")
