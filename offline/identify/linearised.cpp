// SPDX-License-Identifier: MIT
#include "offline/identify/linearised.hpp"

namespace mdhcal::offline {

Triangle sum_of(const std::vector<Triangle>& parts) {
  if (parts.size() == 1) return parts.front();
  Triangle whole(parts.front().unknowns());
  for (const Triangle& part : parts) whole.add(part);
  return whole;
}

Linearised linearised(const Dataset& data, const Selection& selection, const Layout& layout, const Estimate& at,
                      double noise_mm) {
  Linearised out;
  const MeasurementModel model(at);
  out.parts = linearise(model, data, selection, layout, noise_mm);
  Triangle whole = sum_of(out.parts);
  out.system = reduce_frames(whole.matrix(), layout.frame_columns(), whole.row_count());
  const std::vector<double> x = deviation(at, layout);
  out.x0 = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  out.problem = penalised_problem(out.system, out.x0);
  return out;
}

WithoutFold without_fold(const Linearised& whole, const Layout& layout, std::size_t fold) {
  Triangle rest(layout.columns());
  for (std::size_t p = 0; p < whole.parts.size(); ++p) {
    if (p != fold || whole.parts.size() == 1) rest.add(whole.parts[p]);
  }
  WithoutFold out;
  out.system = reduce_frames(rest.matrix(), layout.frame_columns(), rest.row_count());
  out.problem = penalised_problem(out.system, whole.x0);
  return out;
}

Estimate solved(const Estimate& at, const Layout& layout, const ReducedSystem& system, const SpectralProblem& problem,
                const Eigen::VectorXd& x0, double lambda) {
  const auto frames = static_cast<Eigen::Index>(layout.frame_columns());
  Eigen::VectorXd step(frames + x0.size());
  step.tail(x0.size()) = problem.solution(lambda) - x0;
  step.head(frames) = frame_step(system, step.tail(x0.size()));
  return moved(at, layout, step.data());
}

}  // namespace mdhcal::offline
