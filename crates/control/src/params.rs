//! The table of parameters: each tunable declared once; firmware, wire, command line and dashboard derive from it.
