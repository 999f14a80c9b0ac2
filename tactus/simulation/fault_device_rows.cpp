#include <tactus/simulation/internal/fault_families.hpp>

namespace tactus::simulation::fault_families {

std::vector<FaultRow> device_rows() { return {}; }

void draw_device(FaultPlan& plan, signal::Random& random, double sign) {
  switch (plan.kind) {
    case FaultKind::torque_constant:
      plan.length_s = 1.0;
      plan.size = between_logarithms(random, 0.3, 3.0);
      break;
    case FaultKind::actuator_stuck:
      plan.length_s = 1.0;
      plan.size = sign * random.uniform(0.5, 5.0);
      break;
    default:
      break;
  }
}

}  // namespace tactus::simulation::fault_families
