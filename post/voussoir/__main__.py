"""`python3 -m voussoir`."""

import sys

from voussoir.command.main import main

sys.exit(main())
