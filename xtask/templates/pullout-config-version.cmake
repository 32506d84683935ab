# Any version up to this one with the same first number that is not 0 (as Cargo counts compatibility).
set(PACKAGE_VERSION "@VERSION@")
string(REGEX MATCH "^(0\\.[0-9]+|[1-9][0-9]*)" pullout_series "${PACKAGE_VERSION}")
string(REPLACE "." "\\." pullout_series "${pullout_series}")
if(PACKAGE_FIND_VERSION VERSION_GREATER PACKAGE_VERSION OR
   (PACKAGE_FIND_VERSION AND NOT "${PACKAGE_FIND_VERSION}." MATCHES "^${pullout_series}\\."))
  set(PACKAGE_VERSION_COMPATIBLE FALSE)
else()
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
  if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
    set(PACKAGE_VERSION_EXACT TRUE)
  endif()
endif()
unset(pullout_series)
