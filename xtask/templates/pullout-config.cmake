# Pullout @VERSION@: find_package(pullout CONFIG)
#
#   pullout::headers          pullout_umat.h
#   pullout::pullout_laws     all laws with one umat_, uinter_ and fric_; CMNAME selects the law
#   pullout::<law>            the library of one law
#                             both: <law>_umat_ (_uinter_, _fric_), <law>_umat_kratos_, <law>_umat_batch_v1, <law>_plugin_v1
#   pullout_PLUGIN_DIR        the folder of the libraries
#   pullout_FORTRAN_MODULE    source of the module pullout_umat, to be added to a Fortran target

get_filename_component(pullout_PREFIX "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(pullout_PLUGIN_DIR "${pullout_PREFIX}/lib/pullout")
set(pullout_FORTRAN_MODULE "${pullout_PREFIX}/include/pullout_umat.f90")

if(NOT TARGET pullout::headers)
  add_library(pullout::headers INTERFACE IMPORTED)
  set_target_properties(pullout::headers PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${pullout_PREFIX}/include")

  file(GLOB pullout_libraries "${pullout_PLUGIN_DIR}/lib*")
  foreach(pullout_library IN LISTS pullout_libraries)
    get_filename_component(pullout_name "${pullout_library}" NAME_WE)
    string(REGEX REPLACE "^lib" "" pullout_name "${pullout_name}")
    add_library("pullout::${pullout_name}" SHARED IMPORTED)
    # the libraries have no soname: without this property their path would be linked in
    set_target_properties("pullout::${pullout_name}" PROPERTIES
      IMPORTED_LOCATION "${pullout_library}"
      IMPORTED_NO_SONAME TRUE
      INTERFACE_LINK_LIBRARIES pullout::headers)
  endforeach()
  unset(pullout_libraries)
  unset(pullout_library)
  unset(pullout_name)
endif()
