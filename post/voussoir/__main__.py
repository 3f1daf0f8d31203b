"""`python3 -m voussoir`."""

import sys

from voussoir.command_line import main

sys.exit(main())
