#include "coupling/contact_states.h"

#include <algorithm>

namespace monolith {
namespace {

// Whether y_i is friction across the direction of a slipping contact; its normal impulse is y_(i-1) then.
bool isAcross(const ContactRows& contacts, const ContactStates& states, Eigen::Index entry) {
  const Eigen::Index m = contacts.count();
  return entry >= m && states.state[(entry - m) / 2] == ContactState::kSlip;
}

Eigen::Vector2d across(const Eigen::Vector2d& direction) { return {-direction[1], direction[0]}; }

}  // namespace

ContactStates openStates(const ContactRows& contacts) {
  return {std::vector<ContactState>(contacts.count(), ContactState::kOpen), Eigen::VectorXd::Zero(2 * contacts.count()),
          Eigen::VectorXd::Zero(contacts.count())};
}

ContactStates contactStates(const ContactRows& contacts, const Eigen::MatrixXd& D, const Eigen::VectorXd& w,
                            const Eigen::VectorXd& r) {
  const Eigen::Index m = contacts.count();
  ContactStates out = openStates(contacts);
  for (Eigen::Index c = 0; c < m; ++c) {
    const Eigen::Index t = m + 2 * c;
    if (!(D(c, c) * r[c] > w[c])) continue;
    const double response = std::max(D(t, t), D(t + 1, t + 1));
    const Eigen::Vector2d trial = response * r.segment<2>(t) - w.segment<2>(t);
    const double limit = contacts.friction[c] * r[c];
    if (trial.norm() < response * limit) {
      out.state[c] = ContactState::kStick;
    } else {
      out.state[c] = ContactState::kSlip;
      if (!(limit > 0.0)) continue;
      out.direction.segment<2>(2 * c) = trial.normalized();
      // f = mu lambda t/|t| with t = f - w_t/response, linearised: w_t and f across d are as the slip is to friction.
      out.mobility[c] = trial.norm() / limit - response;
    }
  }
  return out;
}

ContactBorder makeBorder(const ContactRows& contacts, const ContactStates& states) {
  const Eigen::Index m = contacts.count();
  ContactBorder out;
  for (Eigen::Index c = 0; c < m; ++c) {
    if (states.state[c] == ContactState::kOpen) continue;
    out.entry.push_back(c);
    if (states.state[c] == ContactState::kStick) {
      out.entry.push_back(m + 2 * c);
      out.entry.push_back(m + 2 * c + 1);
    } else if (states.mobility[c] > 0.0) {
      out.entry.push_back(m + 2 * c);
    }
  }
  const auto k = static_cast<Eigen::Index>(out.entry.size());
  out.R.resize(k, contacts.J.cols());
  out.C.resize(contacts.J.cols(), k);
  out.bias.resize(k);
  out.mobility = Eigen::VectorXd::Zero(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    const Eigen::Index e = out.entry[i];
    if (isAcross(contacts, states, e)) {
      const Eigen::Index c = (e - m) / 2;
      const Eigen::Vector2d p = across(states.direction.segment<2>(2 * c));
      out.R.row(i) = p.transpose() * contacts.J.middleRows<2>(e);
      out.C.col(i) = out.R.row(i).transpose();
      out.bias[i] = p.dot(contacts.bias.segment<2>(e));
      out.mobility[i] = states.mobility[c];
      continue;
    }
    out.R.row(i) = contacts.J.row(e);
    out.C.col(i) = contacts.J.row(e).transpose();
    out.bias[i] = contacts.bias[e];
    if (e < m && states.state[e] == ContactState::kSlip) {
      out.C.col(i) +=
          contacts.friction[e] * (contacts.J.middleRows<2>(m + 2 * e).transpose() * states.direction.segment<2>(2 * e));
    }
  }
  return out;
}

Eigen::VectorXd impulses(const ContactRows& contacts, const ContactStates& states, const ContactBorder& border,
                         const Eigen::VectorXd& y) {
  const Eigen::Index m = contacts.count();
  Eigen::VectorXd r = Eigen::VectorXd::Zero(3 * m);
  for (Eigen::Index i = 0; i < border.count(); ++i) {
    const Eigen::Index e = border.entry[i];
    if (isAcross(contacts, states, e)) {
      r.segment<2>(e) += y[i] * across(states.direction.segment<2>(e - m));
      continue;
    }
    r[e] = y[i];
    if (e < m && states.state[e] == ContactState::kSlip) {
      r.segment<2>(m + 2 * e) = contacts.friction[e] * y[i] * states.direction.segment<2>(2 * e);
    }
  }
  return r;
}

Eigen::VectorXd borderUnknowns(const ContactRows& contacts, const ContactStates& states, const ContactBorder& border,
                               const Eigen::VectorXd& r) {
  Eigen::VectorXd y(border.count());
  for (Eigen::Index i = 0; i < border.count(); ++i) {
    const Eigen::Index e = border.entry[i];
    y[i] = isAcross(contacts, states, e)
               ? across(states.direction.segment<2>(e - contacts.count())).dot(r.segment<2>(e))
               : r[e];
  }
  return y;
}

}  // namespace monolith
