"""Commands for work beyond one machine: scripts of job arrays, gathering their results, compiling before."""
