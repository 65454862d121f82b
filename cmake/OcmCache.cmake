# OCM_CACHE: the folder into which scripts/setup fetches what it does not install.
set(cache "$ENV{XDG_CACHE_HOME}")
if(NOT cache)
  # As in scripts/setup: without HOME, the user's home by passwd.
  execute_process(COMMAND bash -c "[ -n \"$HOME\" ] || unset HOME; echo ~/.cache" OUTPUT_VARIABLE cache OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
set(OCM_CACHE "${cache}/ocm")
