function(ament_target_dependencies)
endfunction()
function(ament_package)
endfunction()
