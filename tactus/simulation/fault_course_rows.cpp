#include <tactus/simulation/internal/fault_families.hpp>

namespace tactus::simulation::fault_families {

std::vector<FaultRow> course_rows() { return {}; }

void draw_course(FaultPlan&, signal::Random&, double) {}

}  // namespace tactus::simulation::fault_families
